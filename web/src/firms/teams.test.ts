import { describe, expect, test } from 'vitest';
import { noTeam, readTeams, writtenTeams } from './teams';

const stated = {
  teams: [
    { name: 'Jansen', first_hour: 7.5, last_hour: 15, ports: ['NLRTM', 'BEANR'] },
    { name: 'Peeters', working_days: ['Tue', 'Sat'], licences: ['NL-114'] },
  ],
  travel_times: [{ from: 'NLRTM', to: 'BEANR', hours: 1.5 }],
};

describe('a firm’s teams', () => {
  test('are read as they were written', () => {
    expect(readTeams(writtenTeams(stated))).toEqual(stated);
  });

  test('need nothing but a name', () => {
    const written = { teams: [{ ...noTeam(), name: ' Jansen ' }], travel: '' };
    expect(readTeams(written)).toEqual({ teams: [{ name: 'Jansen' }], travel_times: [] });
  });

  test.each([
    ['name', { name: ' ' }],
    ['first', { first: 'eight' }],
    ['last', { last: '25' }],
    ['ports', { ports: 'Rotterdam' }],
  ])('with a wrong %s are named', (field, wrong) => {
    const teams = [
      { ...noTeam(), name: 'Jansen' },
      { ...noTeam(), name: 'Peeters', ...wrong },
    ];
    expect(readTeams({ teams, travel: '' })).toEqual({ team: 2, field });
  });

  test('travel between two ports, a line each', () => {
    const read = (travel: string) => readTeams({ teams: [], travel });
    const one = { from: 'NLRTM', to: 'BEANR', hours: 2 };
    expect(read('nlrtm, beanr 2\n\n')).toEqual({ teams: [], travel_times: [one] });
    expect(read('NLRTM BEANR 2\nNLRTM 2')).toEqual({ line: 2 });
  });
});
