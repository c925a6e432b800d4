import { describe, expect, test } from 'vitest';
import { codeOf, portWritten } from './ports';

describe('a port', () => {
  test('is written by its name, and its code behind it', () => {
    expect(portWritten({ code: 'NLRTM', name: 'Rotterdam' })).toBe('Rotterdam (NLRTM)');
    expect(portWritten({ code: 'NLRTM', name: '' })).toBe('NLRTM');
  });

  test('is known by its code alone, or by that behind the name', () => {
    expect(codeOf('NLRTM')).toBe('NLRTM');
    expect(codeOf('Rotterdam (NLRTM)')).toBe('NLRTM');
    expect(codeOf('Valletta')).toBeUndefined();
    expect(codeOf(null)).toBeUndefined();
  });
});
