import { describe, expect, test } from 'vitest';
import { codeOf, portsNamed, portWritten } from './ports';

describe('a port', () => {
  test('is written by its name, and its code behind it', () => {
    expect(portWritten({ code: 'NLRTM', name: 'Rotterdam' })).toBe('Rotterdam (NLRTM)');
    expect(portWritten({ code: 'NLRTM', name: '' })).toBe('NLRTM');
  });

  test('is named in a sentence that has its code, unless the name stands before it', () => {
    const names: Record<string, string> = { BRSSZ: 'Santos', NLRTM: 'Rotterdam' };
    const written = (words: string) => portsNamed(words, (code) => names[code]);
    expect(written('no firm serves Santos (BRSSZ), call BRSSZ 7 Dec 2026')).toBe(
      'no firm serves Santos (BRSSZ), call Santos 7 Dec 2026',
    );
    expect(written('a port that a firm serves: BEANR, NLRTM')).toBe(
      'a port that a firm serves: BEANR, Rotterdam',
    );
    expect(written('MV NLRTMX, 06:00 UTC')).toBe('MV NLRTMX, 06:00 UTC');
  });

  test('is known by its code alone, or by that behind the name', () => {
    expect(codeOf('NLRTM')).toBe('NLRTM');
    expect(codeOf('Rotterdam (NLRTM)')).toBe('NLRTM');
    expect(codeOf('Valletta')).toBeUndefined();
    expect(codeOf(null)).toBeUndefined();
  });
});
