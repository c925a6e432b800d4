import { describe, expect, test } from 'vitest';
import type { BinnacleDesign, PlanStep } from '../api/types';
import { drawing } from './binnacleDrawing';
import { differs } from './found';

const rack = (holes: number) => ({
  carrier: 'hole' as const,
  at_once: 2,
  magnets_each: 2,
  magnets: ['200 mm'],
  holes: Array.from({ length: holes }, (_, i) => ({ number: i + 1, below_card_mm: 600 - 20 * i })),
});
const design = {
  magnets: [{ name: '200 mm', length_mm: 200, moment_am2: 1, moment_tolerance: 0.05 }],
  fore_and_aft: rack(10),
  athwartship: rack(10),
  quadrantal: {
    sizes: [{ name: '7 inch', shape: 'sphere', diameter_mm: 178, tolerance: 0.04 }],
    marks: [{ mark_mm: 300, centre_mm: 305 }],
  },
  flinders: { diameter_mm: 75, axis_mm: 300, longest_mm: 600, sides: ['forward'], tolerance: 0.06 },
} as unknown as BinnacleDesign;

const step = (of: Partial<PlanStep>): PlanStep =>
  ({ action: 'move', corrector: 'fore_and_aft', from: null, to: null, ...of }) as PlanStep;
const magnets = (hole: number, red: 'forward' | 'aft' | 'starboard' | 'port') => ({
  place: 'magnets' as const,
  magnet: '200 mm',
  hole,
  count: 2,
  red,
});

describe('a step drawn', () => {
  test('has the red end towards the bow, to the right, where it points forward', () => {
    const forward = drawing(step({ to: magnets(3, 'forward') }), design);
    expect(forward.ends).toEqual(['aft', 'forward']);
    expect(forward.to).toMatchObject({ kind: 'magnet', red: { x: 0, width: 100 }, count: 2 });
    const aft = drawing(step({ from: magnets(3, 'forward'), to: magnets(5, 'aft') }), design);
    expect(aft.to).toMatchObject({ red: { x: -100, y: 513 } });
    expect(aft.from).toMatchObject({ box: { y: 553 } });
    const port = drawing(step({ corrector: 'athwartship', to: magnets(1, 'port') }), design);
    expect(port.ends).toEqual(['port', 'starboard']);
    expect(port.to).toMatchObject({ red: { x: -100 } });
  });

  test('is as wide as what is drawn', () => {
    const half = (corrector: PlanStep['corrector'], to: PlanStep['to']) =>
      drawing(step({ corrector, to }), design).half;
    expect(half('fore_and_aft', magnets(3, 'forward'))).toBe(240);
    const pair = { place: 'pair' as const, size: '7 inch', mark_mm: 300, slew_deg: 0 };
    expect(half('quadrantal', pair)).toBe(305 + 89 + 20);
  });

  test('says the same in words', () => {
    const { label } = drawing(step({ from: magnets(3, 'forward') }), design);
    expect(label).toBe(
      'Move fore-and-aft magnets. From: hole 3, 2 magnets, 200 mm, red end FORWARD. To: out, to the spares. Seen from starboard.',
    );
  });

  test('has Kelvin spheres on both sides and the bar’s pole at the card', () => {
    const pair = { place: 'pair' as const, size: '7 inch', mark_mm: 300, slew_deg: 0 };
    const spheres = drawing(step({ corrector: 'quadrantal', to: pair }), design);
    expect(spheres.to).toEqual({ kind: 'spheres', apart: 305, radius: 89 });
    expect(spheres.label).toContain('Kelvin spheres');
    expect(spheres.slew).toBe('');
    const slewed = step({ corrector: 'quadrantal', from: pair, to: { ...pair, slew_deg: -12 } });
    expect(drawing(slewed, design).slew).toContain('0° before this step, −12° after it');
    const bar = { place: 'bar' as const, length_mm: 300, side: 'forward' as const, slew_deg: 0 };
    const drawn = drawing(step({ corrector: 'flinders', to: bar }), design).to;
    expect(drawn).toMatchObject({ kind: 'bar', box: { x: 262.5, y: -25, height: 300 } });
  });
});

test('settings differ by a red end, and not by the order of their fields or trays', () => {
  const tray = { hole: 5, magnet: '200 mm', count: 1, red: 'aft' as const };
  const same = { red: 'aft' as const, count: 1, magnet: '200 mm', hole: 5 };
  expect(differs({ fore_and_aft: [tray] }, { fore_and_aft: [same], athwartship: [] })).toBe(false);
  expect(differs({ fore_and_aft: [tray] }, { fore_and_aft: [{ ...tray, red: 'forward' }] })).toBe(
    true,
  );
  const two = [tray, { ...tray, hole: 2 }];
  expect(differs({ fore_and_aft: two }, { fore_and_aft: two.toReversed() })).toBe(false);
});
