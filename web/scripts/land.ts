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
  return feature(atlas, atlas.objects.land)
    .features.flatMap(({ geometry }) =>
      geometry.type === 'MultiPolygon' ? geometry.coordinates : [],
    )
    .flatMap((polygon) => polygon.map(ring))
    .join('');
}

/** A ring in tenths of a unit, each point as the way from the last. */
function ring(points: number[][]): string {
  let [x, y] = [0, 0];
  const steps: string[] = [];
  for (const [lon = 0, lat = 0] of points) {
    const [nextX, nextY] = [Math.round(lon * 10), Math.round(-mercator(lat) * 10)];
    const [dx, dy] = [nextX - x, nextY - y];
    if (steps.length > 0 && dx === 0 && dy === 0) continue;
    steps.push(steps.length === 0 ? `M${nextX} ${nextY}l` : `${dx} ${dy} `);
    [x, y] = [nextX, nextY];
  }
  return steps.length < 4 ? '' : `${steps.join('').trim()}z`;
}

function mercator(lat: number): number {
  const bounded = Math.min(highestLat, Math.max(-highestLat, lat));
  return (180 / Math.PI) * Math.log(Math.tan(Math.PI / 4 + (bounded * Math.PI) / 360));
}
