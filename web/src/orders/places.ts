/** Where a corrector stands, in the words that an adjuster looks for. Pure. */

import type { BinnacleDesign, CorrectorPlace, CorrectorSetting, PlanStep } from '../api/types';
import { typed } from '../format';
import * as text from '../text';

/** A place: where, what of it, and the way the red ends point. */
export interface Written {
  where: string;
  what: string;
  red: string;
}

/** Read when it is needed: the texts may be in a file that is evaluated after this one. */
const t = () => text.berth.step;

export function written(
  place: CorrectorPlace | null,
  corrector: PlanStep['corrector'],
  design?: BinnacleDesign,
): Written | null {
  if (!place) return null;
  switch (place.place) {
    case 'magnets':
      return {
        where: t().hole(carrier(corrector, design), place.hole),
        what: t().magnets(place.count, place.magnet),
        red: t().red[place.red],
      };
    case 'pair':
      return { where: t().mark(typed(place.mark_mm)), what: pair(place), red: '' };
    case 'bar':
      return {
        where: t().length(typed(place.length_mm)),
        what: t().side[place.side] + turned(place.slew_deg ?? 0),
        red: '',
      };
    case 'bucket':
      return {
        where: t().position(place.position),
        what: t().magnets(place.count, design?.heeling?.magnet ?? ''),
        red: t().red[place.red],
      };
  }
}

function pair({ size, slew_deg = 0 }: { size: string; slew_deg?: number }): string {
  if (slew_deg === 0) return size;
  const way = slew_deg > 0 ? t().slewAft : t().slewForward;
  return `${size}, ${t().slew(`${typed(Math.abs(slew_deg))}°`, way)}`;
}

const turned = (slewDeg: number) => (slewDeg === 0 ? '' : `, ${typed(slewDeg)}°`);

function carrier(corrector: PlanStep['corrector'], design?: BinnacleDesign): string {
  const rack = corrector === 'athwartship' ? design?.athwartship : design?.fore_and_aft;
  return t().carriers[rack?.carrier ?? 'hole'] ?? '';
}

/** What is moved, as people call it. */
export function correctorName(step: PlanStep, design?: BinnacleDesign): string {
  const place = step.to ?? step.from;
  if (place?.place !== 'pair') return t().corrector[step.corrector];
  const size = design?.quadrantal?.sizes.find((one) => one.name === place.size);
  return t().shapes[size?.shape ?? 'sphere'];
}

/** How all correctors stand, a line each; what is not in use is not said. */
export function standing(
  setting: CorrectorSetting,
  design?: BinnacleDesign,
): { corrector: string; words: string }[] {
  const line = (corrector: PlanStep['corrector'], place: CorrectorPlace) => {
    const said = written(place, corrector, design);
    const parts = [said?.where, said?.what, said?.red].filter((part) => part);
    return { corrector: t().corrector[corrector], words: parts.join(', ') };
  };
  const { fore_and_aft, athwartship, quadrantal, flinders, heeling } = setting;
  return [
    ...(flinders ? [line('flinders', { place: 'bar', ...flinders })] : []),
    ...(quadrantal ? [line('quadrantal', { place: 'pair', ...quadrantal })] : []),
    ...(heeling ? [line('heeling', { place: 'bucket', ...heeling })] : []),
    ...(fore_and_aft ?? []).map((tray) => line('fore_and_aft', { place: 'magnets', ...tray })),
    ...(athwartship ?? []).map((tray) => line('athwartship', { place: 'magnets', ...tray })),
  ];
}
