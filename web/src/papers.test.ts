import { describe, expect, test } from 'vitest';
import { bookPath, cardPath } from './papers';

describe('the papers of a compass', () => {
  test('a card is of the first compass and the last position unless others are named', () => {
    expect(cardPath('v', 'pdf')).toBe('/api/v1/vessels/v/card.pdf');
    const place = { lat: -33.9, lon: 18.4, at: '2026-11-20T12:00:00.000Z' };
    expect(cardPath('v', 'svg', 'c', place)).toBe(
      '/api/v1/vessels/v/card.svg?compass=c&lat=-33.9&lon=18.4&at=2026-11-20T12%3A00%3A00.000Z',
    );
  });

  test('the last day of a book is in it, also at the end of a year', () => {
    expect(bookPath('v', 'csv', undefined, '2026-12-01', '2026-12-31')).toBe(
      '/api/v1/vessels/v/deviation-book.csv?from=2026-12-01T00%3A00%3A00Z&to=2027-01-01T00%3A00%3A00.000Z',
    );
    expect(bookPath('v', 'pdf', 'c')).toBe('/api/v1/vessels/v/deviation-book.pdf?compass=c');
  });
});
