import { beforeAll, describe, expect, it } from 'vitest';
import * as en from '.';
import * as es from './es';
import { language, languageOf, useCatalogue } from './language';

type Text = string | number | ((...values: unknown[]) => unknown) | { [key: string]: Text };

/** Every text by its path, such as `vessel.rms`. */
function flat(text: Text, path: string): [string, string | ((...values: unknown[]) => unknown)][] {
  if (typeof text === 'string' || typeof text === 'function') return [[path, text]];
  return Object.entries(text).flatMap(([key, part]) => flat(part as Text, `${path}.${key}`));
}

const all = (catalogue: object) =>
  new Map(Object.entries(catalogue).flatMap(([name, text]) => flat(text as Text, name)));

/** Names, symbols, and words that are the same in both languages. */
const same = [
  ...['product', 'utc', 'finder.keys', 'firms.form.portsHint', 'teams.form.travelHint'],
  ...['document.webhooks', 'alerts.toWebhooks', 'webhooks.title', 'settings.webhooks'],
  ...['settings.quotas.names.webhooks', 'settings.tokens.kinds.webhook'],
  ...['settings.clocks.names.utc', 'settings.people.no', 'vessels.imo', 'grade.notable'],
  ...['reports.pdf', 'reports.csv', 'reports.due.nothing', 'table.band', 'residuals.rmsColumn'],
  ...['deviation.showLong.none', 'schedule.facts.plan', 'schedule.plans.version'],
  ...['order.plan.title', 'order.plan.noteWords', 'berth.plans.number', 'berth.reading.horizontal'],
  ...['coverage.ring', 'coverage.north', 'coverage.south', 'order.plan.lambda'],
  ...['fields.nth', 'offers.order', 'messages.by', 'map.chosen', 'vessels.band'],
  ...['changes.likelihood', 'berth.step.hole', 'berth.step.length', 'document.vessel'],
  ...['schedule.job.title', 'schedule.line.work', 'schedule.changes.place', 'now.order'],
  ...['schedule.month.workShort', 'schedule.month.callShort', 'settings.schedule.urgency'],
  ...['parameters.names.chi13.1', 'parameters.names.chi23.1', 'parameters.names.chi12.1'],
  ...['parameters.names.chi21.1', 'parameters.names.chi11_minus_chi22.1'],
  ...['berth.reading.units.microtesla', 'berth.reading.units.nanotesla'],
  ...['berth.reading.units.gauss', 'webhooks.formats.teams'],
];
const sameUnder = ['fields.units.', 'formats.months.'];
const isSame = (path: string) =>
  same.includes(path) || sameUnder.some((start) => path.startsWith(start));

/** Values that no text has in it, of the kinds that the functions take. */
const values = {
  words: Array.from({ length: 8 }, (_, at) => `⟨${String(at)}⟩`),
  none: Array.from({ length: 8 }, () => ''),
  ones: Array.from({ length: 8 }, () => 1),
  named: ['bx, chi13', ...Array.from({ length: 7 }, () => '')],
  many: Array.from({ length: 8 }, (_, at) => 7001 + at),
};

/** Which of the values stand in what is said. */
function shown(text: (...values: unknown[]) => unknown, given: unknown[]): string[] | null {
  try {
    const said = String(text(...given.slice(0, text.length)));
    return given.map(String).filter((value) => value !== '' && said.includes(value));
  } catch {
    // A number where a word is wanted, or the other way round.
    return null;
  }
}

const english = all(structuredCopy(en));
const spanish = all(es);

/** A copy that keeps its texts when the catalogue is put to use. */
function structuredCopy(catalogue: object): object {
  return Object.fromEntries(
    Object.entries(catalogue).map(([name, text]) => [
      name,
      typeof text === 'object' ? { ...(text as object) } : (text as unknown),
    ]),
  );
}

describe('the Spanish catalogue', () => {
  it('has every text of the English one, and no other', () => {
    // Only a field whose name is no English word has an English label.
    const more = (path: string) => path.startsWith('fields.labels.') && !english.has(path);
    const keys = [...spanish.keys()].filter((path) => !more(path));
    expect(keys.sort()).toEqual([...english.keys()].sort());
  });

  it('leaves no text as it is in English, but for names and symbols', () => {
    const left = [...english].filter(([path, text]) => {
      const said = spanish.get(path);
      if (typeof text === 'string') return said === text;
      const words = (of: unknown) =>
        typeof of === 'function' ? attempt(of as (...given: unknown[]) => unknown) : of;
      return words(said) === words(text);
    });
    const found = left.map(([path]) => path);
    expect(found.filter((path) => !isSame(path))).toEqual([]);
    expect(same.filter((path) => !found.includes(path))).toEqual([]);
  });

  it('takes the same values in each text, and shows those that the English one shows', () => {
    const wrong: string[] = [];
    for (const [path, text] of english) {
      if (typeof text !== 'function') continue;
      const said = spanish.get(path);
      if (typeof said !== 'function' || said.length !== text.length) {
        wrong.push(path);
        continue;
      }
      for (const given of [values.words, values.many]) {
        const wanted = shown(text, given);
        const has = shown(said, given);
        if (wanted?.some((value) => has?.includes(value) !== true)) {
          wrong.push(path);
        }
      }
    }
    expect(wrong).toEqual([]);
  });

  it('says something wherever the English one does', () => {
    const silent = [...spanish].filter(([path, text]) => text === '' && english.get(path) !== '');
    expect(silent).toEqual([]);
  });
});

function attempt(text: (...given: unknown[]) => unknown): string {
  return Object.values(values)
    .map((given) => {
      try {
        return String(text(...given));
      } catch {
        return '';
      }
    })
    .join('\n');
}

describe('the language', () => {
  it('is the one chosen here, else the first of the browser’s that there is', () => {
    expect(languageOf('es', ['en-GB'])).toBe('es');
    expect(languageOf(null, ['es-ES', 'en'])).toBe('es');
    expect(languageOf(null, ['ca', 'es-MX', 'en'])).toBe('es');
    expect(languageOf(null, ['de-DE', 'en-US', 'es'])).toBe('en');
    expect(languageOf('none', ['de'])).toBe('en');
  });

  describe('once the catalogue is put to use', () => {
    beforeAll(() => {
      useCatalogue(es);
    });

    it('is Spanish in every text that was loaded before', () => {
      expect(language()).toBe('es');
      const now = all(en);
      expect([...spanish].filter(([path, text]) => now.get(path) !== text)).toEqual([]);
    });

    it('is in the figures and the dates too', async () => {
      const { ago, day, eastWest, euros, hoursAtSea, latitude, signed } = await import('../format');
      expect(eastWest(-3.44)).toBe('3,4° W');
      expect(eastWest(-0.04)).toBe('0,0°');
      expect(signed(-0.5, 1)).toBe('−0,5');
      expect(latitude(54.503)).toBe('54° 30,2′ N');
      expect(day('2026-01-14T08:30:00Z')).toBe('14 ene 2026');
      expect(euros(-1800)).toBe('−1\u202f800\u00a0€');
      expect(ago('2026-01-01T00:00:00Z', new Date('2026-01-05T00:00:00Z'))).toBe('hace 4 días');
      expect(hoursAtSea('2026-12-08T07:00:00Z', '2026-12-08T10:00:00Z', undefined, 'utc')).toBe(
        '8 dic 2026, 07:00 a 10:00 UTC',
      );
    });
  });
});
