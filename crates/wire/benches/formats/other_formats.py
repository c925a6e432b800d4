"""Batches in other formats, none with more digits than a frame."""

import gzip
import json
import sys
import tempfile
from datetime import datetime
from importlib import import_module
from math import radians
from pathlib import Path

import zstandard
from grpc_tools import protoc

HERE = Path(__file__).parent
KNOT_M_S = 1852 / 3600


def compiled():
    """The messages of batch.proto, as protoc makes them."""
    folder = tempfile.mkdtemp()
    if protoc.main(["protoc", f"--proto_path={HERE}", f"--python_out={folder}", "batch.proto"]):
        raise SystemExit("batch.proto cannot be compiled")
    sys.path.insert(0, folder)
    return import_module("batch_pb2")


def seconds(sample):
    return int(datetime.fromisoformat(sample["time"]).timestamp())


def wrapped(degrees):
    return (degrees + 180) % 360 - 180


def json_rows(batch):
    rows = [{k: v for k, v in s.items() if v is not None} for s in batch["samples"]]
    return json.dumps({**batch, "samples": rows}, separators=(",", ":")).encode()


def line_protocol(batch):
    """InfluxDB's: a line a sample, and one for the tally."""
    tag = f"stream={batch['stream']}"
    lines = []
    for s in batch["samples"]:
        fields = [f"{k}={v}" for k, v in s.items() if k not in ("time", "windows") and v is not None]
        fields.append(f"windows={s['windows']}i")
        lines.append(f"sample,{tag} {','.join(fields)} {seconds(s)}")
    if batch["tally"]:
        counts = ",".join(f"{reason}={count}i" for reason, count in batch["tally"].items())
        end = f" {seconds(batch['samples'][-1])}" if batch["samples"] else ""
        lines.append(f"tally,{tag} seq={batch['seq']}i,{counts}{end}")
    return "\n".join(lines).encode()


def signal_k(batch):
    """A delta a sample, as a Signal K server streams them, in its units."""
    context = f"vessels.urn:mrn:signalk:uuid:{batch['stream']}"
    deltas = []
    for s in batch["samples"]:
        place = {"latitude": s["lat"], "longitude": s["lon"]}
        values = {
            "navigation.position": place,
            "navigation.headingCompass": round(radians(s["compass_deg"]), 4),
            "navigation.headingTrue": angle(s["gyro_deg"], 4),
            "navigation.headingTrueSatellite": angle(s["satellite_deg"], 4),
            "navigation.speedOverGround": number(s["sog_kn"], KNOT_M_S, 2),
            "navigation.rateOfTurn": number(s["rate_of_turn_deg_min"], radians(1) / 60, 5),
            "navigation.compassSpread": angle(s["spread_deg"], 4),
            "navigation.compassWindows": s["windows"],
        }
        deltas.append(delta(context, s["time"], values))
    if batch["tally"]:
        time = batch["samples"][-1]["time"] if batch["samples"] else None
        deltas.append(delta(context, time, {"navigation.compassTally": batch["tally"]}))
    return b"\n".join(json.dumps(d, separators=(",", ":")).encode() for d in deltas)


def angle(degrees, digits):
    return number(degrees, radians(1), digits)


def number(value, unit, digits):
    return None if value is None else round(value * unit, digits)


def delta(context, time, values):
    values = [{"path": p, "value": v} for p, v in values.items() if v is not None]
    update = {"$source": "binnacle", "values": values}
    if time:
        update["timestamp"] = time
    return {"context": context, "updates": [update]}


def integers(batch):
    """The samples' values in the steps of FORMAT.md, by column."""
    columns = {name: [] for name in ("time", "lat", "lon", "gyro", "satellite", "compass", "sog",
                                     "rate", "spread", "windows")}
    for s in batch["samples"]:
        gyro, satellite = s["gyro_deg"], s["satellite_deg"]
        base = next((h for h in (gyro, satellite) if h is not None), 0.0)
        columns["time"].append(seconds(s) // 5)
        columns["lat"].append(round(s["lat"] * 1000))
        columns["lon"].append(round(s["lon"] * 1000))
        columns["gyro"].append(steps(gyro, 0.05))
        apart = None if satellite is None else wrapped(satellite - (gyro or 0.0))
        columns["satellite"].append(steps(apart, 0.05))
        columns["compass"].append(steps(wrapped(s["compass_deg"] - base), 0.02))
        columns["sog"].append(steps(s["sog_kn"], 0.2))
        columns["rate"].append(steps(s["rate_of_turn_deg_min"], 0.5))
        columns["spread"].append(steps(s["spread_deg"], 0.02))
        columns["windows"].append(s["windows"])
    return columns


def steps(value, step):
    return None if value is None else round(value / step)


class Protobuf:
    """The messages of batch.proto."""

    FIELDS = {
        "time": "time_5s", "lat": "lat_mdeg", "lon": "lon_mdeg", "gyro": "gyro_5cdeg",
        "satellite": "satellite_less_gyro_5cdeg", "compass": "compass_less_reference_2cdeg",
        "sog": "sog_2dkn", "rate": "rate_of_turn_5ddeg_min", "spread": "spread_2cdeg",
        "windows": "windows",
    }

    def __init__(self):
        self.messages = compiled()

    def head(self, message, batch):
        message.stream = bytes.fromhex(batch["stream"].replace("-", ""))
        message.seq = batch["seq"]
        for reason, count in batch["tally"].items():
            message.tally.add(reason=reason, windows=count)

    def rows(self, batch):
        message, columns = self.messages.Rows(), integers(batch)
        self.head(message, batch)
        for row in range(len(batch["samples"])):
            sample = message.samples.add()
            for name, field in self.FIELDS.items():
                if columns[name][row] is not None:
                    setattr(sample, field, columns[name][row])
        return message.SerializeToString()

    def columns(self, batch):
        message = self.messages.Columns()
        self.head(message, batch)
        for number_, values in enumerate(integers(batch).values(), 1):
            there = [(row, v) for row, v in enumerate(values) if v is not None]
            if not there:
                continue
            column = message.columns.add(id=number_)
            if len(there) < len(values):
                column.rows.extend(row for row, _ in there)
            last = 0
            for _, value in there:
                column.differences.append(value - last)
                last = value
        return message.SerializeToString()


def gzipped(data):
    return gzip.compress(data, 9, mtime=0)


def zstd(data):
    return zstandard.ZstdCompressor(level=19).compress(data)


def forms():
    """Name and encoder of each."""
    protobuf = Protobuf()
    return {
        "JSON": json_rows,
        "JSON + gzip": lambda b: gzipped(json_rows(b)),
        "InfluxDB line protocol + gzip": lambda b: gzipped(line_protocol(b)),
        "Signal K deltas": signal_k,
        "Signal K deltas + gzip": lambda b: gzipped(signal_k(b)),
        "Protobuf rows + zstd": lambda b: zstd(protobuf.rows(b)),
        "Protobuf columns of differences + zstd": lambda b: zstd(protobuf.columns(b)),
    }
