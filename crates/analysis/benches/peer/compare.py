"""Says whether both sides found the same ship, and how their times compare.

`compare.py FOLDER PAIRS PEER APART` with what `scripts/bench-peer` left there; fails when
an unknown differs by more than APART of its standard error, or by more than a tenth
where the peer says what it finds by the product's own levels of noise.
"""

import json
import pathlib
import statistics
import sys

folder, pairs = pathlib.Path(sys.argv[1]), int(sys.argv[2])
name, allowed = sys.argv[3], float(sys.argv[4])


def read(side, pair):
    return json.loads((folder / f"{side}-{pair}.json").read_text())


def furthest(product, unknowns, allowed):
    """How many standard errors apart they are at most."""
    most = 0.0
    for k, (ours, theirs) in enumerate(zip(product["unknowns"], unknowns)):
        apart = abs(ours - theirs) / product["covariance"][k][k] ** 0.5
        most = max(most, apart)
        if not apart <= allowed:
            sys.exit(
                f"unknown {k}: {ours} by the product, {theirs} by {name}:"
                f" {apart:.2g} standard errors apart, {allowed:g} allowed"
            )
    return most


ratios, product_seconds, peer_seconds, told = [], [], [], ""
for pair in range(1, pairs + 1):
    product, peer = read(f"product-{name}", pair), read(name, pair)
    told = f"{furthest(product, peer['unknowns'], allowed):.2g} standard errors apart"
    if "unknowns_by_its_levels" in peer:
        by_its_levels = furthest(product, peer["unknowns_by_its_levels"], 0.1)
        told += f", by the product's levels {by_its_levels:.2g}"
    product_seconds.append(product["processor_seconds"])
    peer_seconds.append(peer["processor_seconds"])
    ratios.append(peer["processor_seconds"] / product["processor_seconds"])

print(f"{product['observations']} observations, the same ship by both, {told}; {pairs} pairs")
print(f"product {statistics.median(product_seconds):.3f} s of processor, median")
print(f"{name} {statistics.median(peer_seconds):.3g} s of processor, median")
low, middle, high = min(ratios), statistics.median(ratios), max(ratios)
print(f"ratio {low:.0f} to {high:.0f}, median {middle:.0f}")
