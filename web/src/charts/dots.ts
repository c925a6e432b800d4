/**
 * Many dots as a few paths: an element for each of a thousand dots costs a phone a second.
 *
 * What always holds: a dot is drawn where its figures are, and one outside of the axes is not.
 */

import * as Plot from '@observablehq/plot';

export interface Dot {
  x: number | Date;
  y: number;
}

/** Dots lie over one another in so many layers, so that many in one place are darker. */
const layers = 4;
/** A cross reaches so far from its middle, pixels. */
const arm = 2.2;

type Style = Record<string, string | number>;

/** Filled dots, `radius` pixels large. */
export function dots(
  of: readonly Dot[],
  radius: number,
  fill: string,
  opacity: number,
): Plot.Markish {
  const style = { stroke: fill, 'stroke-opacity': opacity, 'stroke-width': 2 * radius };
  return marks(of, layers, { ...style, 'stroke-linecap': 'round' }, (x, y) => `M${x} ${y}h0`);
}

/** Crosses, for what was measured and not used. */
export function crosses(of: readonly Dot[], stroke: string): Plot.Markish {
  const across = `m${-arm} ${-arm}l${2 * arm} ${2 * arm}m0 ${-2 * arm}l${-2 * arm} ${2 * arm}`;
  const style = { stroke, 'stroke-opacity': 0.8, 'stroke-width': 1.5 };
  return marks(of, 1, style, (x, y) => `M${x} ${y}${across}`);
}

function marks(
  of: readonly Dot[],
  count: number,
  style: Style,
  draw: (x: string, y: string) => string,
): Plot.Markish {
  return (_index, { x, y }, _channels, { marginTop, marginBottom, height }) => {
    const group = document.createElementNS('http://www.w3.org/2000/svg', 'g');
    group.setAttribute('class', 'dots');
    group.setAttribute('fill', 'none');
    for (const [name, value] of Object.entries(style)) group.setAttribute(name, String(value));
    const drawn = of
      .map((dot) => [Number(x?.(dot.x)), Number(y?.(dot.y))] as const)
      .filter(([, down]) => down >= marginTop && down <= height - marginBottom)
      .map(([right, down]) => draw(right.toFixed(1), down.toFixed(1)));
    for (let layer = 0; layer < Math.min(count, drawn.length); layer++) {
      const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
      path.setAttribute('d', drawn.filter((_, i) => i % count === layer).join(''));
      group.append(path);
    }
    return group;
  };
}
