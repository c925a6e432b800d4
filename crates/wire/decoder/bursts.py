#!/usr/bin/env python3
"""Joins short-burst messages: a second joiner, written from FORMAT.md alone.

Each line of standard input is one message in hexadecimal; each line of output is a frame
that it completed, or "waits", or "refused". Standard library only.
"""

import sys
import zlib

KIND, LONGEST = 0xB1, 340


def varint(data):
    """The number, and what follows it."""
    value = 0
    for index, byte in enumerate(data[:10]):
        value |= (byte & 0x7F) << (7 * index)
        if byte < 0x80:
            if value >> 64:
                break
            return value, data[index + 1:]
    raise ValueError("varint")


class Joiner:
    def __init__(self):
        self.open = {}

    def push(self, message):
        """A frame, or nothing yet."""
        if len(message) > LONGEST or len(message) < 3 or message[0] != KIND:
            raise ValueError("kind")
        content = message[3:]
        check = zlib.crc32(message[:1] + content) & 0xFFFF
        if message[1:3] != check.to_bytes(2, "little") or len(content) < 4:
            raise ValueError("check")
        seq, rest = varint(content[4:])
        if not rest:
            raise ValueError("place")
        part, parts, chunk = rest[0] >> 4, (rest[0] & 15) + 1, rest[1:]
        if part >= parts:
            raise ValueError("part")
        key = (content[:4], seq)
        known = self.open.pop(key, (parts, {}))
        if known[0] != parts or known[1].get(part, chunk) != chunk:
            known = (parts, {})
        known[1][part] = chunk
        if len(known[1]) < parts:
            self.open[key] = known
            return None
        frame = b"".join(known[1][index] for index in range(parts))
        if frame[-4:] != zlib.crc32(frame[:-4]).to_bytes(4, "little"):
            raise ValueError("frame")
        return frame


def main():
    joiner = Joiner()
    for line in sys.stdin:
        try:
            frame = joiner.push(bytes.fromhex(line))
            print(frame.hex() if frame else "waits")
        except ValueError:
            print("refused")


if __name__ == "__main__":
    main()
