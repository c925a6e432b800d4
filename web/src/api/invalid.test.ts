import { describe, expect, it } from 'vitest';
import { invalidInWords, label } from './invalid';
import { readProblem } from './problem';

describe('what a value is refused for', () => {
  it('names the field as the form does, and its place among several', () => {
    expect(label('gross_tonnage')).toBe('Gross tonnage');
    expect(label('steps[2].reading_ut')).toBe('Step 3, Reading');
    expect(label('heeling.magnets[0].length_mm')).toBe('Heeling, Magnet 1, Length (mm)');
    expect(label('lat, lon')).toBe('Latitude, Longitude');
    expect(label('constructor')).toBe('Constructor');
  });

  it('is a sentence', () => {
    expect(invalidInWords('gross_tonnage: is outside 1 to 500000')).toBe(
      '“Gross tonnage” is outside 1 to 500000.',
    );
    expect(invalidInWords('lat: 91 is outside -90 to 90')).toBe(
      '“Latitude”: 91 is outside -90 to 90.',
    );
    expect(invalidInWords('url: is not https')).toBe('“Address” is not https.');
  });

  it('says what was not read, without where in the JSON', () => {
    const unread = 'body: Failed to deserialize the JSON body into the target type: ';
    const cases = [
      [
        'steps[2].reading_ut: missing field `at` at line 1 column 70',
        '“Step 3, Reading, Time” is missing.',
      ],
      ['missing field `email` at line 1 column 20', '“E-mail” is missing.'],
      [
        'unknown field `colour`, expected `name` at line 1 column 9',
        '“Colour” is not known to the server.',
      ],
      [
        'fee_eur: invalid type: string "x", expected f64 at line 1 column 9',
        '“Fee” must be a number.',
      ],
      [
        'teams: invalid value: integer `-1`, expected u8 at line 1 column 9',
        '“Teams” must be a whole number, and not below zero.',
      ],
      ['name: invalid type: null, expected a string at line 1 column 9', '“Name” must be a text.'],
      [
        'role: unknown variant `x`, expected `a` or `b` at line 1 column 9',
        '“Role” is not one of the choices.',
      ],
    ] as const;
    for (const [said, words] of cases) expect(invalidInWords(unread + said)).toBe(words);
  });

  it('leaves alone what names no field', () => {
    for (const said of [
      'the schedule is being made',
      'line 3, column eta: is no time',
      'A sentence: with a colon.',
    ]) {
      expect(invalidInWords(said)).toBe(said);
    }
  });

  it('changes nothing else that the server says', () => {
    const said = (kind: string) =>
      readProblem(422, { type: `/problems/${kind}`, detail: 'planned_at: is past' }).message;
    expect(said('invalid')).toBe('“Planned time” is past.');
    expect(said('wrong-state')).toBe('planned_at: is past');
  });
});
