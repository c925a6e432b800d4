/**
 * A step drawn: the binnacle cut through, with the corrector where it was and where it goes.
 * Millimetres from the card's centre, down positive. Pure.
 *
 * What always holds: fore-and-aft magnets and the Flinders bar are seen from starboard, with the
 * bow to the right; everything else from aft, with starboard to the right.
 */

import type { BinnacleDesign, CorrectorPlace, PlanStep } from '../api/types';
import * as text from '../text';
import { correctorName, written } from './places';

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** A corrector at one place. */
export type Drawn =
  | { kind: 'magnet'; box: Box; /** The half with the red end. */ red: Box; count: number }
  | { kind: 'spheres'; apart: number; radius: number }
  | { kind: 'bar'; box: Box };

export interface Drawing {
  /** Words on the left and on the right. */
  ends: [string, string];
  /** Places of the magnets of the step's rack or bucket, below the card. */
  holes: { number: number; y: number }[];
  from: Drawn | null;
  to: Drawn | null;
  /** Half the width of the picture. */
  half: number;
  /** Depth of the picture. */
  depth: number;
  /** What of a slew the picture does not show; empty where nothing is slewed. */
  slew: string;
  /** The same in words. */
  label: string;
}

/** Thickness of a magnet as drawn. */
const THICK = 14;
/** Room below the lowest place. */
const MARGIN = 50;
/** The column and the places' numbers beside it take so much on either side. */
const COLUMN = 240;
/** Room beside a corrector, and for how many magnets it is. */
const [BESIDE, COUNT] = [20, 64];

export function drawing(step: PlanStep, design: BinnacleDesign): Drawing {
  const along = step.corrector === 'fore_and_aft' || step.corrector === 'flinders';
  const holes = places(step.corrector, design);
  const [from, to] = [step.from, step.to].map((place) => drawn(place ?? null, holes, design));
  const depths = [...holes.map((hole) => hole.y), bottom(from), bottom(to), 200];
  const t = text.berth.step;
  return {
    ends: along ? [t.drawing.aft, t.drawing.forward] : [t.drawing.port, t.drawing.starboard],
    holes,
    from: from ?? null,
    to: to ?? null,
    half: Math.max(COLUMN, reach(from), reach(to)),
    depth: Math.max(...depths) + MARGIN,
    slew: slew(step),
    label: [
      `${t.action[step.action]} ${inSentence(correctorName(step, design))}.`,
      said(t.from, step.from ?? null, t.nowhere),
      said(t.to, step.to ?? null, t.out),
      along ? t.drawing.fromStarboard : t.drawing.fromAft,
    ].join(' '),
  };

  function said(what: string, place: CorrectorPlace | null, none: string): string {
    const words = written(place, step.corrector, design);
    const parts = words ? [words.where, words.what, words.red].filter((part) => part) : [none];
    return `${what}: ${parts.join(', ')}.`;
  }
}

function places(corrector: PlanStep['corrector'], design: BinnacleDesign): Drawing['holes'] {
  const at = ({ number, below_card_mm }: { number: number; below_card_mm: number }) => ({
    number,
    y: below_card_mm,
  });
  if (corrector === 'heeling') return (design.heeling?.positions ?? []).map(at);
  if (corrector !== 'fore_and_aft' && corrector !== 'athwartship') return [];
  return design[corrector].holes.map(at);
}

function drawn(
  place: CorrectorPlace | null,
  holes: Drawing['holes'],
  design: BinnacleDesign,
): Drawn | null {
  if (!place) return null;
  const length = (kind: string | undefined) =>
    design.magnets.find((magnet) => magnet.name === kind)?.length_mm ?? 0;
  switch (place.place) {
    case 'magnets': {
      const y = holes.find((hole) => hole.number === place.hole)?.y ?? 0;
      const long = length(place.magnet);
      const box = { x: -long / 2, y: y - THICK / 2, width: long, height: THICK };
      const right = place.red === 'forward' || place.red === 'starboard';
      const red = { ...box, x: right ? 0 : box.x, width: long / 2 };
      return { kind: 'magnet', box, red, count: place.count };
    }
    case 'bucket': {
      const y = holes.find((hole) => hole.number === place.position)?.y ?? 0;
      const long = length(design.heeling?.magnet);
      const box = { x: -THICK / 2, y: y - long / 2, width: THICK, height: long };
      const red = { ...box, y: place.red === 'up' ? box.y : y, height: long / 2 };
      return { kind: 'magnet', box, red, count: place.count };
    }
    case 'pair': {
      const iron = design.quadrantal;
      const mark = iron?.marks.find((one) => Math.abs(one.mark_mm - place.mark_mm) < 1e-6);
      const size = iron?.sizes.find((one) => one.name === place.size);
      return {
        kind: 'spheres',
        apart: mark?.centre_mm ?? place.mark_mm,
        radius: (size?.diameter_mm ?? 0) / 2,
      };
    }
    case 'bar': {
      const holder = design.flinders;
      const wide = holder?.diameter_mm ?? 0;
      const middle = (place.side === 'forward' ? 1 : -1) * (holder?.axis_mm ?? 0);
      // Its upper pole, a twelfth of the length from its end, is at the card's height.
      const y = -place.length_mm / 12;
      return {
        kind: 'bar',
        box: { x: middle - wide / 2, y, width: wide, height: place.length_mm },
      };
    }
  }
}

/** A name within a sentence: the bar keeps the capital of its inventor, as the spheres do. */
function inSentence(name: string): string {
  const proper = [text.berth.step.corrector.flinders, text.berth.step.shapes.sphere];
  return proper.includes(name) ? name : name.charAt(0).toLowerCase() + name.slice(1);
}

/** Slews before and after, clockwise as seen from above. */
function slew({ from, to }: PlanStep): string {
  const of = (place: CorrectorPlace | null | undefined) =>
    place?.place === 'pair' || place?.place === 'bar' ? (place.slew_deg ?? 0) : 0;
  if (of(from) === 0 && of(to) === 0) return '';
  const [before, after] = [of(from), of(to)].map((deg) => `${deg}°`.replace('-', '−'));
  return text.berth.step.drawing.slew(before ?? '', after ?? '');
}

/** How far a corrector reaches to either side. */
function reach(of: Drawn | null | undefined): number {
  if (!of) return 0;
  if (of.kind === 'spheres') return of.apart + of.radius + BESIDE;
  const { x, width } = of.box;
  const count = of.kind === 'magnet' && of.count > 1 ? COUNT : 0;
  return Math.max(-x, x + width + count) + BESIDE;
}

function bottom(of: Drawn | null | undefined): number {
  if (!of) return 0;
  return of.kind === 'spheres' ? of.radius : of.box.y + of.box.height;
}
