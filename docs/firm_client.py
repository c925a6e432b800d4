#!/usr/bin/env python3
"""An adjuster firm's side of Binnacle, as an example to start from.

Needs Python 3.9 or later and the `openssl` command, nothing else. The server and an API
token of the firm's (scope `write`) come from the environment:

    export BINNACLE_SERVER=https://binnacle.example BINNACLE_TOKEN=bna_...
    python3 firm_client.py orders
    python3 firm_client.py propose ORDER --fee 900 --text "Two teams are needed."
    python3 firm_client.py accept ORDER --adjuster "M. Etxeberria" --licence ES-CA-114
    python3 firm_client.py say ORDER --text "Is there a crane alongside?"
    python3 firm_client.py messages ORDER
    python3 firm_client.py events
    python3 firm_client.py on-board ORDER
    python3 firm_client.py adjust ORDER --as-found found.json --reading reading.json
    python3 firm_client.py adjust ORDER
    python3 firm_client.py complete ORDER --adjuster "M. Etxeberria" --licence ES-CA-114
    python3 firm_client.py register-key --key firm.pem --name "Office, 2026"
    python3 firm_client.py sign ORDER --key firm.pem
    python3 firm_client.py evidence ORDER --out evidence.zip
    python3 firm_client.py check-webhook --secret bns_... --header "$SIGNATURE" < body

`adjust` asks after each step what the compass reads, and before the first where the reading
does not say; `--as-foretold` answers for you, to try it out. Without a reading it goes on
where it was left.
"""

import argparse
import hashlib
import hmac
import http.client
import json
import os
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
import uuid


class Refused(Exception):
    """The server said no: a problem document (RFC 9457)."""

    def __init__(self, problem):
        super().__init__(problem.get("detail", "refused"))
        self.problem = problem


class Binnacle:
    """The API, as far as a firm needs it."""

    def __init__(self, server, token, tries=5):
        self.base = server.rstrip("/") + "/api/v1"
        self.token = token
        self.tries = tries

    def ask(self, method, path, body=None):
        """Sends a request; the same key with each try, so that it is done once."""
        headers = {"Authorization": "Bearer " + self.token}
        data = None
        if method != "GET":
            headers["Idempotency-Key"] = str(uuid.uuid4())
        if body is not None:
            data = json.dumps(body).encode()
            headers["Content-Type"] = "application/json"
        request = urllib.request.Request(
            self.base + path, data=data, headers=headers, method=method
        )
        for attempt in range(1, self.tries + 1):
            try:
                with urllib.request.urlopen(request, timeout=60) as answer:
                    return answer.read()
            except urllib.error.HTTPError as error:
                if error.code < 500 or attempt == self.tries:
                    raise Refused(problem_of(error)) from error
            except (OSError, http.client.HTTPException):
                # Also where the connection breaks while the answer is read: what is sent again
                # under its key is written once.
                if attempt == self.tries:
                    raise
            time.sleep(2**attempt)
        raise AssertionError("the last try returns or raises")

    def get(self, path):
        return json.loads(self.ask("GET", path))

    def post(self, path, body):
        answer = self.ask("POST", path, body)
        return json.loads(answer) if answer else None

    def every(self, path):
        """All items of a list, page by page."""
        joint = "&" if "?" in path else "?"
        after = ""
        while True:
            page = self.get(path + after)
            yield from page["items"]
            if page["next"] is None:
                return
            after = joint + "after=" + page["next"]


    def events(self, last=None):
        """Follows what happens to the firm's orders: (id, event), one after the other.

        The server ends a stream after half an hour, and a connection may break: go on from
        the last id, and what was missed comes first.
        """
        headers = {"Authorization": "Bearer " + self.token}
        if last is not None:
            headers["Last-Event-ID"] = last
        request = urllib.request.Request(self.base + "/events", headers=headers)
        with urllib.request.urlopen(request, timeout=60) as stream:
            fields = {}
            for line in stream:
                name, _, value = line.decode().rstrip("\r\n").partition(":")
                if name:
                    fields[name] = value.strip()
                elif line.strip() == b"" and "data" in fields:
                    yield fields.get("id"), json.loads(fields["data"])
                    fields = {}


def problem_of(error):
    try:
        return json.loads(error.read())
    except ValueError:
        return {"detail": "status %d" % error.code}


def adjust(api, order_id, found, reading, read_compass):
    """Reports how it was found, reads the berth, takes the recommended plan, does its steps.

    Without a reading it goes on where the order stands.
    """
    path = "/work-orders/" + order_id
    if reading is None:
        return do_steps(api, path, api.get(path), read_compass, is_known=False)
    model = api.get(path + "/model")
    binnacle = api.get(path + "/binnacle")
    print("model version %d, binnacle revision %d" % (model["version"], binnacle["revision"]))
    if found is not None:
        api.post(path + "/as-found", found)
    order = api.post(path + "/berth-reading", reading)
    offer = api.get(path + "/plan")
    print("%d plans, the recommended one first" % len(offer["plans"]))
    order = api.post(path + "/plan", {"plan": 1})
    is_known = reading.get("compass_deg") is not None
    return do_steps(api, path, order, read_compass, is_known)


def json_file(name):
    if name is None:
        return None
    with open(name, encoding="utf-8") as file:
        return json.load(file)


def do_steps(api, path, order, read_compass, is_known):
    """`is_known`: whether the server has heard what the compass reads before the first."""
    while order["next_step"] is not None:
        step = order["next_step"]
        print("%d. %s" % (step["number"], step["words"]))
        read = {} if is_known else {"before_deg": read_compass(step, "before")}
        read["after_deg"] = read_compass(step, "after")
        order = api.post("%s/steps/%d" % (path, step["number"]), read)
        print("   " + order["last_step"]["words"])
        is_known = True
    return order


def ask_for_compass(step, when):
    return float(input("   the compass reads, %s the step, degrees: " % when))


def as_foretold(step, when):
    after_deg = step["expected_compass_deg"]
    return after_deg if when == "after" else (after_deg - step["change_deg"]) % 360


def openssl(*arguments):
    done = subprocess.run(["openssl", *arguments], check=True, capture_output=True)
    return done.stdout


def public_key(key_file):
    """The last 32 bytes of the key's DER form (RFC 8410)."""
    return openssl("pkey", "-in", key_file, "-pubout", "-outform", "DER")[-32:].hex()


def signature(key_file, message):
    with tempfile.NamedTemporaryFile() as file:
        file.write(message)
        file.flush()
        signed = openssl("pkeyutl", "-sign", "-rawin", "-inkey", key_file, "-in", file.name)
    return signed.hex()


def register_key(api, key_file, name):
    """Registers a key, with a signature by it that shows whose it is."""
    firm_id = api.get("/me")["firm_id"]
    proof = signature(key_file, ("binnacle firm key " + firm_id).encode())
    new = {"name": name, "public_key": public_key(key_file), "proof": proof}
    return api.post("/firms/%s/keys" % firm_id, new)


def sign(api, order_id, key_file):
    """Signs the record's SHA-256, as it was read and not as it was said."""
    path = "/work-orders/" + order_id
    digest = hashlib.sha256(api.ask("GET", path + "/record.json")).digest()
    said = api.get(path)["completion"]["record_sha256"]
    if digest.hex() != said:
        raise SystemExit("the record is not the one that was completed")
    signed = {"public_key": public_key(key_file), "signature": signature(key_file, digest)}
    order = api.post(path + "/signatures", signed)
    return order["signatures"][-1]["key"]


def is_from_binnacle(secret, header, body, now=None, tolerance_s=300):
    """Whether `body` (bytes) was signed with `secret` within `tolerance_s`."""
    fields = dict(field.split("=", 1) for field in header.split(",") if "=" in field)
    sent = fields.get("t", "")
    if not sent.isascii() or not sent.isdigit():
        return False
    if abs((time.time() if now is None else now) - int(sent)) > tolerance_s:
        return False
    expected = hmac.new(secret.encode(), sent.encode() + b"." + body, hashlib.sha256)
    return hmac.compare_digest(expected.hexdigest().encode(), fields.get("v1", "").encode())


def show(order):
    state = order["state"]
    if order["answer_by"] is not None:
        state += ", answer by " + order["answer_by"]
    where = order["port"] + (", " + order["berth"] if order["berth"] else "")
    who = "%s (%s)" % (order["vessel_name"], order["compass_name"])
    print("%s  %s  %s  %s  %s" % (order["id"], order["planned_at"], where, who, state))


def show_fee(order):
    """What the firm is offered and, once it has the order, what was agreed on."""
    for offer in order["offers"]:
        if offer["fee_eur"] is not None:
            print("offered at %.2f euros" % offer["fee_eur"])
        if offer["terms"] is not None:
            print("terms: " + json.dumps(offer["terms"]))
    if order["fee_eur"] is not None:
        print("agreed at %.2f euros" % order["fee_eur"])


def follow(api, last, count):
    """Prints events; begins again where a stream ends, and stops after `count` of them."""
    while True:
        try:
            for last, event in api.events(last):
                print("%s  %s  order %s" % (last, event["kind"], event.get("order_id")), flush=True)
                if count is not None:
                    count -= 1
                    if count == 0:
                        return
        except urllib.error.HTTPError as error:
            if error.code < 500:
                raise Refused(problem_of(error)) from error
        except (OSError, http.client.HTTPException):
            pass
        time.sleep(2)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("orders", help="list your orders")
    for name, words in [
        ("order", "show an order, and for how much it is offered"),
        ("accept", "take an order as it is offered"),
        ("propose", "propose another time, berth or fee"),
        ("messages", "read what you and the operator wrote"),
        ("say", "write to the operator"),
        ("decline", "decline an offer, or give an order back"),
        ("on-board", "say that the adjuster is on board"),
        ("adjust", "read the berth and do the plan's steps"),
        ("complete", "say that it is done"),
        ("sign", "sign the record with the firm's key"),
        ("evidence", "fetch the evidence"),
    ]:
        command = commands.add_parser(name, help=words)
        command.add_argument("order")
        if name in ("accept", "complete"):
            command.add_argument("--adjuster", required=True)
            command.add_argument("--licence", required=True)
        if name == "propose":
            command.add_argument("--at", help="RFC 3339, as 2026-12-08T13:00:00Z")
            command.add_argument("--berth")
            command.add_argument("--fee", type=float, help="euros")
        if name in ("decline", "propose"):
            command.add_argument("--text")
        if name == "say":
            command.add_argument("--text", required=True)
        if name == "adjust":
            command.add_argument(
                "--as-found", help="a JSON file: every corrector's setting, and the checks alongside"
            )
            command.add_argument("--reading", help="a JSON file; without it, go on with the steps")
            command.add_argument("--as-foretold", action="store_true")
        if name == "sign":
            command.add_argument("--key", required=True, help="an Ed25519 key, PEM")
        if name == "evidence":
            command.add_argument("--out", required=True)
    command = commands.add_parser("events", help="follow what happens to your orders")
    command.add_argument("--last", help="the id of the last event that you saw")
    command.add_argument("--count", type=int, help="stop after so many")
    command = commands.add_parser("register-key", help="register a key of the firm's")
    command.add_argument("--key", required=True, help="an Ed25519 key, PEM")
    command.add_argument("--name", required=True)
    command = commands.add_parser("check-webhook", help="check a message on standard input")
    command.add_argument("--secret", required=True)
    command.add_argument("--header", required=True, help="the header Binnacle-Signature")
    command.add_argument("--now", type=int, help="seconds since 1970, to check an old one")
    return parser.parse_args()


def run(asked):
    if asked.command == "check-webhook":
        body = sys.stdin.buffer.read()
        good = is_from_binnacle(asked.secret, asked.header, body, asked.now)
        print("from Binnacle" if good else "not from Binnacle, or too old")
        return 0 if good else 1
    api = Binnacle(os.environ["BINNACLE_SERVER"], os.environ["BINNACLE_TOKEN"])
    if asked.command == "orders":
        for order in api.every("/work-orders"):
            show(order)
        return 0
    if asked.command == "events":
        follow(api, asked.last, asked.count)
        return 0
    if asked.command == "register-key":
        print("registered as " + register_key(api, asked.key, asked.name)["id"])
        return 0
    path = "/work-orders/" + asked.order
    if asked.command == "order":
        order = api.get(path)
        show(order)
        show_fee(order)
    elif asked.command == "propose":
        # What is left out is as it was offered.
        new = {"planned_at": asked.at, "berth": asked.berth, "fee_eur": asked.fee}
        terms = {name: value for name, value in new.items() if value is not None}
        show(api.post(path + "/propose", {"terms": terms, "text": asked.text}))
    elif asked.command == "messages":
        for message in api.every(path + "/messages"):
            print("%s  %s: %s" % (message["at"], message["by"], message["text"]))
    elif asked.command == "say":
        api.post(path + "/messages", {"text": asked.text})
    elif asked.command == "accept":
        who = {"adjuster_name": asked.adjuster, "adjuster_licence": asked.licence}
        show(api.post(path + "/accept", who))
    elif asked.command == "decline":
        api.post(path + "/decline", {"text": asked.text})
        print("declined")
    elif asked.command == "on-board":
        show(api.post(path + "/on-board", {}))
    elif asked.command == "adjust":
        found, reading = [json_file(name) for name in (asked.as_found, asked.reading)]
        read_compass = as_foretold if asked.as_foretold else ask_for_compass
        show(adjust(api, asked.order, found, reading, read_compass))
    elif asked.command == "complete":
        word = {
            "adjuster_name": asked.adjuster,
            "adjuster_licence": asked.licence,
            "firm": api.get("/me")["firm_name"],
            "signature": asked.adjuster,
        }
        show(api.post(path + "/complete", word))
    elif asked.command == "sign":
        key = sign(api, asked.order, asked.key)
        print("signed with an unknown key" if key is None else "signed with " + key["name"])
    elif asked.command == "evidence":
        with open(asked.out, "wb") as file:
            file.write(api.ask("GET", path + "/evidence.zip"))
        print("written to " + asked.out)
    return 0


def main():
    try:
        return run(arguments())
    except Refused as refused:
        print(json.dumps(refused.problem), file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
