/**
 * `virtual:land`: the coasts as one SVG path in the map's own units, made from Natural
 * Earth's 1:110m land (npm world-atlas, public domain) when the dashboard is built, so
 * that no page ever asks a tile server. Units: see src/map/mercator.ts.
 */
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { feature } from 'topojson-client';
import type { GeometryCollection, Topology } from 'topojson-specification';
import type { Plugin } from 'vite';

const id = 'virtual:land';
const resolved = `\0${id}`;
/** Beyond, no ship sails by a magnetic compass; as in src/map/mercator.ts. */
const highestLat = 80;

export function land(): Plugin {
  return {
    name: 'binnacle-land',
    resolveId: (asked) => (asked === id ? resolved : undefined),
    load: (asked) =>
      asked === resolved ? `export const land = ${JSON.stringify(path())};` : undefined,
  };
}

function path(): string {
  const file = createRequire(import.meta.url).resolve('world-atlas/land-110m.json');
  const atlas = JSON.parse(readFileSync(file, 'utf8')) as Topology<{ land: GeometryCollection }>;
  const rings = feature(atlas, atlas.objects.land).features.flatMap(({ geometry }) =>
    geometry.type === 'MultiPolygon' ? geometry.coordinates.flat() : [],
  );
  return joined(rings).map(ring).join('');
}

/** The atlas cuts an island in two along the antimeridian; the cut is no coast. */
function joined(rings: number[][][]): number[][][] {
  const whole: number[][][] = [];
  for (const ring of rings) {
    const cut = cutOf(ring);
    const other = whole.findIndex((known) => {
      const theirs = cutOf(known);
      return theirs?.to === cut?.from && theirs?.from === cut?.to;
    });
    if (!cut || other < 0) whole.push(ring);
    else whole[other] = [...fromCut(whole[other] ?? []), ...fromCut(ring)];
  }
  return whole;
}

/** A ring's step along the antimeridian: where it begins, and from which latitude to which. */
function cutOf(ring: number[][]): { at: number; from: string; to: string } | null {
  const onIt = (point?: number[]) => Math.abs(Math.abs(point?.[0] ?? 0) - 180) < 1e-9;
  const lat = (point?: number[]) => (point?.[1] ?? 0).toFixed(6);
  const at = ring.findIndex((point, i) => i > 0 && onIt(point) && onIt(ring[i - 1])) - 1;
  return at < 0 ? null : { at, from: lat(ring[at]), to: lat(ring[at + 1]) };
}

/** The ring from the end of its cut round to the beginning. */
function fromCut(ring: number[][]): number[][] {
  const at = cutOf(ring)?.at ?? 0;
  return [...ring.slice(at + 1, -1), ...ring.slice(0, at + 1)];
}

/** A ring in tenths of a unit, each point as the way from the last. */
function ring(points: number[][]): string {
  let [x, y] = [0, 0];
  const steps: string[] = [];
  for (const [lon, lat] of unwrapped(points)) {
    const [nextX, nextY] = [Math.round(lon * 10), Math.round(-mercator(lat) * 10)];
    const [dx, dy] = [nextX - x, nextY - y];
    if (steps.length > 0 && dx === 0 && dy === 0) continue;
    steps.push(steps.length === 0 ? `M${nextX} ${nextY}l` : `${dx} ${dy} `);
    [x, y] = [nextX, nextY];
  }
  return steps.length < 4 ? '' : `${steps.join('').trim()}z`;
}

/**
 * A ring whose every step goes the short way: over the antimeridian the longitude runs on
 * beyond 180°, for the atlas jumps there to -180° and the line would cross the whole map.
 * Its middle is within [-180, 180), so that the map's copies of it cover every view. A ring
 * round a pole is closed along the map's edge.
 */
function unwrapped(points: number[][]): [lon: number, lat: number][] {
  let last = points[0]?.[0] ?? 0;
  const run = points.map(([lon = 0, lat = 0]): [number, number] => {
    last += wrapped(lon - last);
    return [last, lat];
  });
  const [start = 0, end = 0] = [run[0]?.[0], run.at(-1)?.[0]];
  if (Math.abs(end - start) > 180) {
    const pole = (run[0]?.[1] ?? 0) < 0 ? -90 : 90;
    run.push([end, pole], [(start + end) / 2, pole], [start, pole]);
  }
  const lons = run.map(([lon]) => lon);
  const middle = (Math.min(...lons) + Math.max(...lons)) / 2;
  return run.map(([lon, lat]) => [lon - middle + wrapped(middle), lat]);
}

/** The same longitude in [-180, 180); as in src/map/mercator.ts. */
function wrapped(lon: number): number {
  return ((((lon + 180) % 360) + 360) % 360) - 180;
}

function mercator(lat: number): number {
  const bounded = Math.min(highestLat, Math.max(-highestLat, lat));
  return (180 / Math.PI) * Math.log(Math.tan(Math.PI / 4 + (bounded * Math.PI) / 360));
}
