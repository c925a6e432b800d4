import { expect, test } from 'vitest';
import { setTag } from './tags';

function server(tags: string[] | undefined) {
  const sent: string[][] = [];
  const putTags = (_: string, tags: string[]) => Promise.resolve(sent.push(tags));
  return { sent, find: () => Promise.resolve(tags), putTags };
}

test('a tag is added to those that the server has now, and taken from them', async () => {
  const hers = server(['atlantic', 'given meanwhile']);
  expect(await setTag('Nao', 'reefer', true, hers)).toBe(true);
  expect(await setTag('Nao', 'atlantic', false, hers)).toBe(true);
  expect(hers.sent).toEqual([['atlantic', 'given meanwhile', 'reefer'], ['given meanwhile']]);
});

test('nothing is sent where nothing changes, or where the vessel is gone', async () => {
  for (const hers of [server(['reefer']), server(undefined)]) {
    expect(await setTag('Nao', 'reefer', true, hers)).toBe(false);
    expect(hers.sent).toEqual([]);
  }
});
