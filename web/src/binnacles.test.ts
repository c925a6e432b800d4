import { describe, expect, test } from 'vitest';
import type { Binnacle, BinnacleDesign, FleetBinnacle } from './api/types';
import {
  aboardInWords,
  binnacleOf,
  draftOf,
  fault,
  imported,
  newBinnacle,
  piecesOf,
  soughtBinnacles,
} from './binnacles';

const rack = { carrier: 'tray', at_once: 2, magnets_each: 4, magnets: ['200 mm'], holes: [] };
const design = {
  version: 1,
  maker: 'Maker',
  model: 'Model',
  magnets: [{ name: '200 mm' }, { name: 'heeling' }],
  fore_and_aft: rack,
  athwartship: rack,
} as unknown as BinnacleDesign;

const aboard: Binnacle = {
  version: 1,
  serial: '1234',
  type: design,
  aboard: {
    magnets: [{ magnet: '200 mm', count: 12, tested_moment_am2: 0.97, tested_sd: 0.05 }],
    quadrantal: ['7 inch'],
    flinders_pieces_mm: [300, 75, 75],
  },
  setting: { fore_and_aft: [{ hole: 5, magnet: '200 mm', count: 2, red: 'aft' }] },
  calibration: [{ corrector: 'heeling' } as never],
};

describe('a binnacle', () => {
  test('that is not touched is written as it was', () => {
    const again = binnacleOf(draftOf(aboard), aboard);
    expect(again.aboard).toEqual(aboard.aboard);
    expect(again.calibration).toEqual(aboard.calibration);
    expect(again.setting.fore_and_aft).toEqual(aboard.setting.fore_and_aft);
  });

  test('of another type keeps nothing that was measured of the old one', () => {
    const other = { ...design, model: 'Other' };
    expect(binnacleOf({ ...newBinnacle(other, '1'), serial: '1' }, aboard).calibration).toEqual([]);
  });

  test('whose magnets were tested anew loses the old error', () => {
    const draft = draftOf(aboard);
    draft.tested['200 mm'] = '0,95';
    expect(binnacleOf(draft, aboard).aboard.magnets).toEqual([
      { magnet: '200 mm', count: 12, tested_moment_am2: 0.95 },
    ]);
  });

  test('says what is wrong before it is sent', () => {
    const good = draftOf(aboard);
    expect(fault(good)).toBeUndefined();
    expect(fault({ ...good, serial: ' ' })).toMatch(/serial number/);
    expect(fault({ ...good, counts: { '200 mm': '1.5' } })).toMatch(/whole number/);
    expect(fault({ ...good, tested: { '200 mm': '-1' } })).toMatch(/greater than 0/);
    expect(fault({ ...good, pieces: '300, x' })).toMatch(/Flinders bar/);
  });

  test('has pieces with commas or blanks between', () => {
    expect(piecesOf('300, 75 75;')).toEqual([300, 75, 75]);
    expect(piecesOf('')).toEqual([]);
    expect(piecesOf('-1')).toBeNull();
  });

  test('comes from a file, and another file is told from one', () => {
    expect(imported(JSON.stringify(aboard))).toEqual(aboard);
    for (const other of [
      '',
      '[]',
      'null',
      '{"version":1}',
      '{"serial":"1","type":{"magnets":[]}}',
    ]) {
      expect(imported(other)).toBeNull();
    }
  });
});

describe('the fleet’s binnacles', () => {
  const of = (vessel: string, compass: string, serial?: string): FleetBinnacle => ({
    vessel_id: vessel,
    vessel_name: vessel,
    compass_id: `${vessel} ${compass}`,
    compass_name: compass,
    role: 'standard',
    binnacle:
      serial === undefined
        ? null
        : {
            maker: 'Cassens',
            model: 'Trays',
            serial,
            aboard: aboard.aboard,
            measured_effects: 0,
            revision: 1,
            at: '2026-11-01T00:00:00Z',
            by: 'Ada',
            reason: null,
          },
  });
  const fleet = [
    of('Óbidos', 'Standard', '17'),
    of('Nao', 'Standard', '18'),
    of('Pinta', 'Steering'),
  ];
  const names = (search: string) => soughtBinnacles(fleet, search).map((one) => one.vessel_name);

  test('begin with those of which nothing can be planned, then go by name', () => {
    expect(names('')).toEqual(['Pinta', 'Nao', 'Óbidos']);
  });

  test('are found by ship, compass, maker or number, without accents', () => {
    expect(names('obidos')).toEqual(['Óbidos']);
    expect(names('steering')).toEqual(['Pinta']);
    expect(names('cassens 18')).toEqual(['Nao']);
    expect(names('nobody')).toEqual([]);
  });

  test('say what is on board as people count it', () => {
    expect(aboardInWords(aboard.aboard)).toEqual([
      '12 magnets, 200 mm',
      'pair of 7 inch',
      'Flinders bar in pieces of 300, 75, 75 mm',
    ]);
    expect(aboardInWords({ magnets: [] })).toEqual([]);
  });
});
