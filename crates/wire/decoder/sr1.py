#!/usr/bin/env python3
"""Reads sr1 frames: a second decoder, written from FORMAT.md alone.

Each line of standard input is one frame in hexadecimal; each line of output is
the batch as JSON, or {"error": kind} with the same kinds as the Rust decoder.
Standard library only.
"""

import json
import sys
import uuid
import zlib
from datetime import datetime, timedelta, timezone

REASONS = [
    "accepted", "slow", "turning", "settling", "swinging", "no_compass",
    "no_reference", "no_position", "no_speed", "hold_berthed",
    "hold_magnetic_cargo", "hold_degaussing", "high_latitude", "clock", "sparse",
    "no_time",
]
TIME, LAT, LON, GYRO, SATELLITE, COMPASS, SOG, RATE_OF_TURN, SPREAD, WINDOWS = range(1, 11)
COURSE, ROLL, ROLL_SPREAD, TEMPERATURE, GYRO_SOURCE, SATELLITE_SOURCE = range(11, 17)
REQUIRED = (TIME, LAT, LON, COMPASS, WINDOWS)
DIRECTIONS = (LON, GYRO, SATELLITE, COMPASS, COURSE)
LIMIT = 1 << 53
STATES = ("open", "agree", "not_judged")
FIRST_SECOND, LAST_SECOND = 315_964_800, 4_102_444_800
MAX_BYTES, MAX_SAMPLES, MAX_COLUMNS = 262_144, 65_535, 64


class Refused(Exception):
    """The reason why bytes are not a batch, by the kind's name."""


class Bits:
    """Bits, the most significant of each byte first."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def left(self):
        return len(self.data) * 8 - self.at

    def take(self, count):
        if count > self.left():
            raise Refused("Truncated")
        value = 0
        for _ in range(count):
            byte = self.data[self.at >> 3]
            value = value << 1 | byte >> (7 - (self.at & 7)) & 1
            self.at += 1
        return value

    def gamma(self):
        below = 0
        while self.take(1) == 0:
            below += 1
            if below > 63:
                raise Refused("NumberTooLong")
        return 1 << below | self.take(below)

    def varint(self):
        value = 0
        for group in range(10):
            byte = self.take(8)
            value |= (byte & 0x7F) << (7 * group)
            if value >= 1 << 64:
                raise Refused("NumberTooLong")
            if byte < 0x80:
                return value
        raise Refused("NumberTooLong")


def unzigzag(code):
    return code >> 1 if code % 2 == 0 else -(code + 1 >> 1)


def clamp(value):
    return max(-LIMIT, min(LIMIT, value))


class PredictorState:
    """The state of a predictor in one column."""

    def __init__(self, predictor, value, time):
        self.predictor, self.first = predictor, value
        self.last, self.before = (value, time), None
        self.mean, self.greatest = value * 256, value

    def predict(self, time):
        value, at = self.last
        if self.predictor == 0:
            return self.first
        if self.predictor == 8:
            return clamp(min(time - at - value, self.greatest))
        if 3 <= self.predictor <= 6:
            return clamp((self.mean + 128) // 256)
        if self.predictor == 2 and self.before:
            return clamp(2 * value - self.before[0])
        if self.predictor == 7 and self.before and at > self.before[1]:
            rise = (value - self.before[0]) * (time - at)
            return clamp(value + rise // (at - self.before[1]))
        return value

    def update(self, value, time):
        self.before, self.last = self.last, (value, time)
        self.greatest = max(self.greatest, value)
        if 3 <= self.predictor <= 6:
            self.mean += (value * 256 - self.mean) >> (self.predictor - 2)


def read_residuals(bits, count):
    while count > 0:
        block = min(count, 128)
        count -= block
        code = bits.take(4)
        if code == 15:
            yield from [0] * block
        elif code == 14:
            while block > 0:
                zeros = bits.gamma() - 1
                if zeros > block:
                    raise Refused("BadRun")
                yield from [0] * zeros
                block -= zeros
                if block > 0:
                    yield unzigzag(bits.gamma())
                    block -= 1
        else:
            for _ in range(block):
                quotient = 0
                while quotient < 24 and bits.take(1):
                    quotient += 1
                if quotient < 24:
                    yield unzigzag(quotient << code | bits.take(code))
                else:
                    yield unzigzag(bits.take(bits.take(6) + 1))


def read_presence(bits, count):
    if bits.take(1) == 0:
        return [True] * count
    presence, there = [], True
    while len(presence) < count:
        run = bits.gamma() - 1
        if run > count - len(presence):
            raise Refused("BadRun")
        presence += [there] * run
        there = not there
    return presence


def read_column(bits, count, times):
    rows = [row for row, there in enumerate(read_presence(bits, count)) if there]
    values = [None] * count
    if not rows:
        return values
    predictor = bits.take(3)
    if predictor == 7 and times is None:
        raise Refused("BadPredictor")
    time = (lambda row: times[row]) if times else (lambda row: 0)
    values[rows[0]] = unzigzag(bits.varint())
    if abs(values[rows[0]]) > LIMIT:
        raise Refused("OutOfRange")
    state = PredictorState(predictor, values[rows[0]], time(rows[0]))
    for row, residual in zip(rows[1:], read_residuals(bits, len(rows) - 1)):
        values[row] = state.predict(time(row)) + residual
        if abs(values[row]) > LIMIT:
            raise Refused("OutOfRange")
        state.update(values[row], time(row))
    return values


class Range:
    """Bits from a dense frame's bytes, which are the digits of a number from 0 up to 1."""

    def __init__(self, data):
        self.data, self.taken, self.number, self.range = data, 0, 0, 1 << 32
        for _ in range(4):
            self.take_byte()

    def take_byte(self):
        if self.taken >= len(self.data) + 4:
            raise Refused("Truncated")
        byte = self.data[self.taken] if self.taken < len(self.data) else 0
        self.taken += 1
        self.number = self.number << 8 | byte

    def narrow(self, zero_share):
        bit = self.number >= zero_share
        if bit:
            self.number -= zero_share
        self.range = self.range - zero_share if bit else zero_share
        while self.range < 1 << 24:
            self.take_byte()
            self.range <<= 8
        return int(bit)

    def take(self, count):
        value = 0
        for _ in range(count):
            value = value << 1 | self.narrow(self.range // 2)
        return value

    def modelled_bit(self, model):
        bit = self.narrow(self.range // (model[0] + model[1]) * model[0])
        model[bit] += 5
        if model[0] + model[1] > 320:
            model[0], model[1] = (model[0] + 1) // 2, (model[1] + 1) // 2
        return bit

    def finish(self):
        if self.taken + 1 < len(self.data) + 4:
            raise Refused("TrailingBits")


class ResidualModels:
    """Adaptive bit models of a column's residuals."""

    def __init__(self):
        self.longer = [[2, 2] for _ in range(55)]
        self.negative = [2, 2]
        self.second = [[2, 2] for _ in range(56)]

    def residual(self, bits):
        length = 0
        while length < 55 and bits.modelled_bit(self.longer[length]):
            length += 1
        if length == 0:
            return 0
        sign = -1 if bits.modelled_bit(self.negative) else 1
        size = 1
        if length > 1:
            size = 2 + bits.modelled_bit(self.second[length])
            size = size << (length - 2) | bits.take(length - 2)
        return sign * size


def read_dense_column(bits, count, times):
    presence = [True] * count
    if bits.take(1):
        model, before = [[2, 2], [2, 2]], 1
        for row in range(count):
            before = presence[row] = bits.modelled_bit(model[before])
    rows = [row for row, there in enumerate(presence) if there]
    values = [None] * count
    if not rows:
        return values
    predictor = bits.take(4)
    if predictor > 8 or predictor >= 7 and times is None:
        raise Refused("BadPredictor")
    time = (lambda row: times[row]) if times else (lambda row: 0)
    length = bits.take(6)
    values[rows[0]] = unzigzag(1 << (length - 1) | bits.take(length - 1) if length else 0)
    if abs(values[rows[0]]) > LIMIT:
        raise Refused("OutOfRange")
    state, models = PredictorState(predictor, values[rows[0]], time(rows[0])), ResidualModels()
    for row in rows[1:]:
        values[row] = state.predict(time(row)) + models.residual(bits)
        if abs(values[row]) > LIMIT:
            raise Refused("OutOfRange")
        state.update(values[row], time(row))
    return values


def read_tally(bits):
    tally = {}
    for entry in range(bits.varint()):
        number = bits.varint() if entry < 255 else None
        if number == 0:
            length = bits.varint()
            if not 1 <= length <= 64:
                raise Refused("BadReason")
            text = bytes(bits.take(8) for _ in range(length))
            try:
                name = text.decode("utf-8")
            except UnicodeDecodeError:
                raise Refused("BadReason") from None
        elif number is not None and number <= len(REASONS):
            name = REASONS[number - 1]
        else:
            raise Refused("BadReason")
        count = bits.varint()
        if name in tally:
            raise Refused("BadReason")
        tally[name] = count
    return tally


def instant(seconds):
    if not FIRST_SECOND <= seconds < LAST_SECOND:
        raise Refused("BadNote")
    return datetime.fromtimestamp(seconds, timezone.utc).isoformat().replace("+00:00", "Z")


def read_alert(bits):
    alert = {"id": str(uuid.UUID(int=bits.take(128))), "revision": bits.varint()}
    state = bits.take(8)
    if state >= len(STATES) or not 1 <= alert["revision"] < 1 << 32:
        raise Refused("BadNote")
    alert["state"] = STATES[state]
    alert["since"] = instant(bits.varint())
    alert["at"] = instant(bits.varint())
    there = bits.take(8)
    for bit, name in ((1, "gyro_departure_deg"), (2, "satellite_departure_deg")):
        alert[name] = unzigzag(bits.varint()) / 10 if there & bit else None
    alert["limit_deg"] = bits.varint() / 10
    alert["model_version"] = bits.varint()
    angles = (alert["gyro_departure_deg"], alert["satellite_departure_deg"], alert["limit_deg"])
    if any(abs(angle or 0) > 180 for angle in angles) or alert["model_version"] >= 1 << 32:
        raise Refused("BadNote")
    return alert


def read_notes(bits):
    notes, count = {}, bits.varint()
    if count > 255:
        raise Refused("TooManyNotes")
    for _ in range(count):
        kind, length = bits.varint(), bits.varint()
        if length > bits.left() // 8:
            raise Refused("Truncated")
        note = Bits(bytes(bits.take(8) for _ in range(length)))
        try:
            if kind == 1:
                notes.setdefault("alerts", []).append(read_alert(note))
            elif kind == 2:
                if "thinned" in notes:
                    raise Refused("BadNote")
                notes["thinned"] = {"samples": note.varint(), "windows": note.varint()}
        except Refused:
            raise Refused("BadNote") from None
    return notes


def exact(value, exponent):
    """value / 10^exponent, rounded once, as a whole number where JSON has one."""
    return value / 10**exponent


class Sample:
    """Exact decimals: (units, exponent) for each column of one row."""

    def __init__(self, columns, row):
        self.columns, self.row = columns, row

    def get(self, column):
        if column not in self.columns:
            return None
        (mantissa, exponent), values = self.columns[column]
        value = values[self.row]
        return None if value is None else (value * mantissa, exponent)

    def need(self, column):
        found = self.get(column)
        if found is None:
            raise Refused("MissingColumn")
        return found

    def within(self, column, low, high):
        found = self.get(column)
        if found is None:
            return None
        if not low <= exact(*found) <= high:
            raise Refused("OutOfRange")
        return exact(*found)


def plus(a, b):
    exponent = max(a[1], b[1])
    units = a[0] * 10 ** (exponent - a[1]) + b[0] * 10 ** (exponent - b[1])
    return units % (360 * 10**exponent), exponent


def read_sample(row):
    time = row.need(TIME)
    row.within(TIME, 315_964_800, 4_102_444_800)
    lon, exponent = row.need(LON)
    circle = 360 * 10**exponent
    lon = exact((lon + circle // 2) % circle - circle // 2, exponent)
    lat = exact(*row.need(LAT))
    if not -90 <= lat <= 90:
        raise Refused("OutOfRange")
    gyro, satellite = row.get(GYRO), row.get(SATELLITE)
    if gyro is not None:
        gyro = plus(gyro, (0, 0))
    if satellite is not None:
        satellite = plus(satellite, gyro or (0, 0))
    compass = plus(row.need(COMPASS), gyro or satellite or (0, 0))
    course = row.get(COURSE)
    if course is not None:
        course = exact(*plus(course, gyro or satellite or (0, 0)))
    row.need(WINDOWS)
    micros = time[0] * 10**6 // 10 ** time[1]
    instant = datetime(1970, 1, 1, tzinfo=timezone.utc) + timedelta(microseconds=micros)
    later = {
        "cog_deg": course,
        "roll_deg": row.within(ROLL, -90, 90),
        "roll_spread_deg": row.within(ROLL_SPREAD, 0, 90),
        "temperature_c": row.within(TEMPERATURE, -100, 100),
        "gyro_source": row.within(GYRO_SOURCE, 0, 65_535),
        "satellite_source": row.within(SATELLITE_SOURCE, 0, 65_535),
    }
    for source in ("gyro_source", "satellite_source"):
        if later[source] is not None:
            later[source] = int(later[source])
    return {
        "time": instant.isoformat().replace("+00:00", "Z"),
        "lat": lat,
        "lon": lon,
        "compass_deg": exact(*compass),
        "gyro_deg": exact(*gyro) if gyro else None,
        "satellite_deg": exact(*satellite) if satellite else None,
        "windows": int(row.within(WINDOWS, 1, 65_535)),
        "sog_kn": row.within(SOG, 0, 200),
        "rate_of_turn_deg_min": row.within(RATE_OF_TURN, -3600, 3600),
        "spread_deg": row.within(SPREAD, 0, 180),
        **{name: value for name, value in later.items() if value is not None},
    }


def content(data):
    if len(data) > MAX_BYTES:
        raise Refused("TooLarge")
    if data[:2] != b"BN"[: len(data)]:
        raise Refused("BadMagic")
    if len(data) < 8:
        raise Refused("Truncated")
    if int.from_bytes(data[-4:], "little") != zlib.crc32(data[:-4]):
        raise Refused("Checksum")
    if data[2] != 1:
        raise Refused("UnsupportedVersion")
    if data[3] & ~3:
        raise Refused("UnsupportedFlags")
    return data[4:-4]


def read_profile(bits):
    profile, last = [], 0
    for index in range(bits.varint()):
        column = bits.varint()
        if index >= MAX_COLUMNS or column <= last:
            raise Refused("ColumnOrder")
        step = bits.take(8)
        if step < 16:
            raise Refused("BadStep")
        profile.append((column, (step >> 4, step & 15)))
        last = column
    return profile


def read_columns(profile, read):
    columns, times = {}, None
    for column, step in profile:
        values = read(times)
        if column == TIME:
            if None in values:
                raise Refused("MissingColumn")
            times = values
        columns[column] = (step, values)
    return columns


def decode(data):
    bits = Bits(content(data))
    stream = uuid.UUID(int=bits.take(128))
    seq = bits.varint()
    if seq == 0:
        raise Refused("SeqZero")
    tally = read_tally(bits)
    notes = read_notes(bits) if data[3] & 1 else {}
    count = bits.varint()
    if count > MAX_SAMPLES:
        raise Refused("TooManySamples")
    profile = read_profile(bits)
    if data[3] & 2:
        bits = Range(bits.data[bits.at // 8 :])
        columns = read_columns(profile, lambda times: read_dense_column(bits, count, times))
        bits.finish()
    else:
        least = 12 + 4 * ((count + 126) // 128)
        if count > 0 and len(REQUIRED) * least > bits.left():
            raise Refused("TooManySamples")
        columns = read_columns(profile, lambda times: read_column(bits, count, times))
        if bits.left() > 7 or bits.take(bits.left()) != 0:
            raise Refused("TrailingBits")
    for column, ((mantissa, exponent), _) in columns.items():
        if column in DIRECTIONS and 360 * 10**exponent % mantissa != 0:
            raise Refused("BadStep")
    samples = []
    for row in range(count):
        samples.append(read_sample(Sample(columns, row)))
        if row and samples[-2]["time"] > samples[-1]["time"]:
            raise Refused("OutOfOrder")
    return {"stream": str(stream), "seq": seq, "tally": tally, "samples": samples, **notes}


def main():
    for line in sys.stdin:
        try:
            answer = decode(bytes.fromhex(line))
        except Refused as refused:
            answer = {"error": str(refused)}
        print(json.dumps(answer))


if __name__ == "__main__":
    main()
