import { render } from 'svelte/server';
import { expect, test } from 'vitest';
import type { FirmWithTerms } from '../../api/types';
import { words } from '../testing';
import FirmCard from './FirmCard.svelte';
import TeamsForm from './TeamsForm.svelte';

const jansen = { name: 'Jansen', first_hour: 7.5, last_hour: 15, ports: ['NLRTM'] };
const peeters = { name: 'Peeters', working_days: ['Tue'], licences: ['NL-114'] };

test('a firm’s card shows the teams that it states in the place of their number', () => {
  const firm = {
    firm_id: 'f',
    firm_name: 'Maas Compass',
    terms: { fee_eur: 1800, teams: 1, jobs_a_team_day: 2 },
    teams: [jansen, peeters],
    problems: [],
  } satisfies FirmWithTerms;
  const nothing = () => Promise.resolve();
  const card = (teams: FirmWithTerms['teams']) =>
    words(
      render(FirmCard, {
        props: { firm: { ...firm, teams }, keys: [], writes: false, save: nothing, end: nothing },
      }),
    );
  expect(card(firm.teams)).toContain('2 on a working day, 2 jobs each as the firm states them');
  expect(card(firm.teams)).toContain('Jansen from 07:30 · until 15:00 · at NLRTM');
  expect(card(firm.teams)).toContain('Peeters Tuesday · licences NL-114');
  expect(card([])).toContain('1 on a working day, 2 jobs each');
  expect(card([])).not.toContain('as the firm states them');
});

test('the form of the teams has a field for each that may differ, and names its team', () => {
  const props = {
    stated: { teams: [jansen], travel_times: [{ from: 'NLRTM', to: 'BEANR', hours: 1.5 }] },
    save: () => Promise.resolve(),
    oncancel: () => undefined,
  };
  const { body } = render(TeamsForm, { props });
  expect(words({ body })).toContain('Team 1 Name Begins at, the port’s time (empty: as in terms)');
  expect(body).toContain('value="7.5"');
  expect(body).toContain('NLRTM BEANR 1.5');
  expect(words({ body })).toContain('Remove Jansen');
});
