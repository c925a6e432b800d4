import { render } from 'svelte/server';
import { expect, test } from 'vitest';
import type { Checked } from '../checklist';
import Checklist from './start/Checklist.svelte';
import { words } from './testing';

const nao: Checked = {
  ...{ id: 'nao', name: 'Nao', agent: false, model: false, call: false, missing: 3 },
  compasses: [
    { id: 's', name: 'Standard', adjusted: null },
    { id: 't', name: 'Steering', adjusted: '2025-03-01' },
  ],
};
const of = (vessel: Checked, writes: boolean) =>
  render(Checklist, {
    props: {
      ...{ vessels: [vessel], today: '2026-11-28', writes },
      record: () => Promise.resolve(),
    },
  });

test('the checklist has a line for each compass, and leads to the panels', () => {
  const rendered = of(nao, true);
  expect(words(rendered)).toContain('Standard: Not known Record the date Steering: 1 Mar 2025');
  expect(rendered.body).toContain('aria-label="Record the date: Nao, Standard"');
  expect(rendered.body).toContain('href="/vessels/nao/agent"');
  expect(rendered.body).toContain('href="/vessels/nao/settings#particulars"');
});

test('a viewer, who may not record it, is not asked when a compass was adjusted', () => {
  expect(words(of(nao, false))).not.toContain('Record the date');
});

test('a vessel of which no rule has asked anything is not complete', () => {
  const shown = words(of({ ...nao, compasses: [], missing: null }, true));
  expect(shown).toMatch(/No compass .* Not known yet$/);
});
