/**
 * The form of a binnacle on board: what is typed, and the binnacle that it makes. Pure;
 * the server checks it whole.
 */

import type { Binnacle, BinnacleDesign, CorrectorSetting, FleetBinnacle } from './api/types';
import { number } from './orders/reading';
import { plainly } from './plainly';
import * as text from './text';

/** What stands in the fields. */
export interface BinnacleDraft {
  design: BinnacleDesign;
  serial: string;
  /** By kind of magnet. */
  counts: Record<string, string>;
  tested: Record<string, string>;
  /** Sizes of which there is a pair. */
  pairs: string[];
  pieces: string;
  setting: CorrectorSetting;
}

export function newBinnacle(design: BinnacleDesign, serial = ''): BinnacleDraft {
  const every = (value: string) =>
    Object.fromEntries(design.magnets.map((kind) => [kind.name, value]));
  return {
    design,
    serial,
    counts: every('0'),
    tested: every(''),
    pairs: [],
    pieces: '',
    setting: { fore_and_aft: [], athwartship: [], quadrantal: null, flinders: null, heeling: null },
  };
}

export function draftOf(binnacle: Binnacle): BinnacleDraft {
  const draft = newBinnacle(binnacle.type, binnacle.serial);
  for (const lot of binnacle.aboard.magnets) {
    draft.counts[lot.magnet] = String(lot.count);
    draft.tested[lot.magnet] = String(lot.tested_moment_am2 ?? '');
  }
  return {
    ...draft,
    pairs: [...(binnacle.aboard.quadrantal ?? [])],
    pieces: (binnacle.aboard.flinders_pieces_mm ?? []).join(', '),
    setting: { ...draft.setting, ...structuredClone(binnacle.setting) },
  };
}

/** Lengths with commas or blanks between; `null` where one of them is none. */
export function piecesOf(typed: string): number[] | null {
  const parts = typed.split(/[,;\s]+/).filter((part) => part !== '');
  const lengths = parts.map(Number);
  return lengths.every((length) => Number.isFinite(length) && length > 0) ? lengths : null;
}

/** What is wrong with a draft before the server sees it. */
export function fault(draft: BinnacleDraft): string | undefined {
  const t = text.binnacles;
  if (draft.serial.trim() === '') return t.serialMissing;
  if (!Object.values(draft.counts).every((typed) => /^\d+$/.test(typed.trim()))) {
    return t.countWrong;
  }
  const tested = Object.values(draft.tested).filter((typed) => typed.trim() !== '');
  if (!tested.every((typed) => (number(typed) ?? 0) > 0)) return t.testedWrong;
  return piecesOf(draft.pieces) === null ? t.piecesWrong : undefined;
}

/**
 * The binnacle that a draft without fault makes. What was measured of `before` stays
 * with it as long as the design does.
 */
export function binnacleOf(draft: BinnacleDraft, before?: Binnacle): Binnacle {
  const lots = Object.entries(draft.counts).map(([magnet, typed]) => {
    const was = before?.aboard.magnets.find((lot) => lot.magnet === magnet);
    const tested = number(draft.tested[magnet] ?? '');
    const same = tested !== null && was?.tested_moment_am2 === tested;
    return {
      magnet,
      count: Number(typed),
      ...(tested === null ? {} : { tested_moment_am2: tested }),
      ...(same && typeof was.tested_sd === 'number' ? { tested_sd: was.tested_sd } : {}),
    };
  });
  const sameDesign =
    before?.type.maker === draft.design.maker && before.type.model === draft.design.model;
  return {
    version: 1,
    serial: draft.serial.trim(),
    type: draft.design,
    aboard: {
      magnets: lots.filter((lot) => lot.count > 0),
      quadrantal: draft.pairs,
      flinders_pieces_mm: piecesOf(draft.pieces) ?? [],
    },
    setting: draft.setting,
    calibration: sameDesign ? (before.calibration ?? []) : [],
  };
}

/** A file that may be a binnacle; `null` where it cannot be one. */
export function imported(content: string): Binnacle | null {
  try {
    const found = JSON.parse(content) as Partial<Binnacle> | null;
    const whole =
      typeof found?.serial === 'string' &&
      Array.isArray(found.type?.magnets) &&
      Array.isArray(found.type.fore_and_aft.holes) &&
      Array.isArray(found.type.athwartship.holes) &&
      Array.isArray(found.aboard?.magnets) &&
      typeof found.setting === 'object';
    return whole ? (found as Binnacle) : null;
  } catch {
    return null;
  }
}

type Aboard = Pick<Binnacle['aboard'], 'magnets' | 'quadrantal' | 'flinders_pieces_mm'>;

/** The correctors on board, a line each, as people count them. */
export function aboardInWords(aboard: Aboard): string[] {
  const { bar, pair } = text.binnacles;
  const pieces = aboard.flinders_pieces_mm ?? [];
  return [
    ...aboard.magnets.map((lot) => text.berth.step.magnets(lot.count, lot.magnet)),
    ...(aboard.quadrantal ?? []).map((size) => pair(size)),
    ...(pieces.length > 0 ? [bar(pieces.join(', '))] : []),
  ];
}

/** Those with these words in what they say: where nothing is entered first, then by name. */
export function soughtBinnacles(all: readonly FleetBinnacle[], search: string): FleetBinnacle[] {
  const words = plainly(search).split(/\s+/).filter(Boolean);
  return all
    .filter((one) => {
      const { maker = '', model = '', serial = '' } = one.binnacle ?? {};
      const hay = plainly([one.vessel_name, one.compass_name, maker, model, serial].join(' '));
      return words.every((word) => hay.includes(word));
    })
    .sort(
      (a, b) =>
        Number(a.binnacle !== null) - Number(b.binnacle !== null) ||
        a.vessel_name.localeCompare(b.vessel_name, 'en') ||
        a.compass_name.localeCompare(b.compass_name, 'en'),
    );
}
