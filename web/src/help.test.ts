import { expect, test } from 'vitest';
import { loadIndex, topics } from 'virtual:help';
import { passages, sectionOf, type Searched } from './help';

const section = (id: string, title: string, text: string) => ({ id, title, text });
const topic = (id: string, title: string, sections: Searched['sections']): Searched => ({
  ...{ id, title, sections },
});
const some = [
  topic('cards', 'Cards', [section('', '', 'The band decides whether a card is made.')]),
  topic('alerts', 'Alerts', [section('band', 'The band', 'It is too wide.')]),
];

test('passages have every word sought, and one in a title comes first', () => {
  expect(passages(some, 'Band').map(({ topic }) => topic.id)).toEqual(['alerts', 'cards']);
  expect(passages(some, 'band card').map(({ topic }) => topic.id)).toEqual(['cards']);
  expect(passages(some, ' ')).toEqual([]);
});

test('a hash names a section, and one written wrongly none', () => {
  expect(sectionOf('#caf%C3%A9')).toBe('café');
  expect(sectionOf('#100%')).toBe('100%');
});

test('no topic names a file of the documents, and every link within the help leads somewhere', async () => {
  const index = await loadIndex();
  const pages = await Promise.all(topics.map(({ load }) => load()));
  expect(index.map(({ id }) => id)).toEqual(topics.map(({ id }) => id));
  expect(pages.filter((html) => html.length < 200)).toEqual([]);
  const known = new Set(
    index.flatMap(({ id, sections }) => [
      `/help/${id}`,
      ...sections.filter(({ id }) => id !== '').map((one) => `/help/${id}#${one.id}`),
    ]),
  );
  const words = [...pages, ...index.flatMap(({ sections }) => sections.map(({ text }) => text))];
  expect(words.flatMap((text) => text.match(/docs\/[\w-]+\.md/g) ?? [])).toEqual([]);
  const links = pages.flatMap((html) =>
    [...html.matchAll(/href="(?!https?:)([^"]*)"/g)].map(([, href]) => href ?? ''),
  );
  expect(links.length).toBeGreaterThan(20);
  expect(links.filter((link) => !known.has(link))).toEqual([]);
});
