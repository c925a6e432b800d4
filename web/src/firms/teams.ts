/** A firm's teams as they are written in a form, and read from it. Pure. */

import type { FirmTeam, FirmTeams, TravelTime } from '../api/types';
import * as text from '../text';
import { clock, list, weekdays } from './terms';

/** A team's fields; an empty one is as in the operators' terms. */
export interface WrittenTeam {
  name: string;
  first: string;
  last: string;
  days: string[];
  licences: string;
  ports: string;
}

export interface WrittenTeams {
  teams: WrittenTeam[];
  travel: string;
}

/** What is wrong: a team's field, or a line of the travel times; both from 1. */
export type WrongTeams =
  { team: number; field: 'name' | 'first' | 'last' | 'ports' } | { line: number };

export const noTeam = (): WrittenTeam => ({
  name: '',
  first: '',
  last: '',
  days: [],
  licences: '',
  ports: '',
});

export function writtenTeams({ teams = [], travel_times = [] }: FirmTeams): WrittenTeams {
  const of = (value: number | null | undefined) => (value === null ? '' : String(value ?? ''));
  return {
    teams: teams.map((team) => ({
      name: team.name,
      first: of(team.first_hour),
      last: of(team.last_hour),
      days: team.working_days ?? [],
      licences: (team.licences ?? []).join(', '),
      ports: (team.ports ?? []).join(', '),
    })),
    travel: travel_times.map(({ from, to, hours }) => `${from} ${to} ${hours}`).join('\n'),
  };
}

const code = /^[A-Z]{2}[A-Z2-9]{3}$/;
const way =
  /^\s*([A-Za-z]{2}[A-Za-z2-9]{3})[\s,;]+([A-Za-z]{2}[A-Za-z2-9]{3})[\s,;]+(\d+(?:\.\d+)?)\s*$/;

export function readTeams(written: WrittenTeams): FirmTeams | WrongTeams {
  const teams: FirmTeam[] = [];
  for (const [n, team] of written.teams.entries()) {
    const field = faultOf(team);
    if (field) return { team: n + 1, field };
    const ports = portsOf(team);
    const licences = list(team.licences);
    teams.push({
      name: team.name.trim(),
      ...(team.first.trim() === '' ? {} : { first_hour: Number(team.first) }),
      ...(team.last.trim() === '' ? {} : { last_hour: Number(team.last) }),
      ...(team.days.length === 0
        ? {}
        : { working_days: weekdays.filter((day) => team.days.includes(day)) }),
      ...(licences.length === 0 ? {} : { licences }),
      ...(ports.length === 0 ? {} : { ports }),
    });
  }
  const travel_times: TravelTime[] = [];
  for (const [n, line] of written.travel.split('\n').entries()) {
    if (line.trim() === '') continue;
    const found = way.exec(line);
    if (!found) return { line: n + 1 };
    const [, from = '', to = '', hours = ''] = found;
    travel_times.push({
      from: from.toUpperCase(),
      to: to.toUpperCase(),
      hours: Number(hours),
    });
  }
  return { teams, travel_times };
}

const portsOf = (team: WrittenTeam): string[] =>
  list(team.ports).map((port) => port.replace(/\s/g, '').toUpperCase());

function faultOf(team: WrittenTeam): 'name' | 'first' | 'last' | 'ports' | undefined {
  const isHour = (typed: string) =>
    typed.trim() === '' || (Number(typed) >= 0 && Number(typed) <= 24);
  if (team.name.trim() === '') return 'name';
  if (!isHour(team.first)) return 'first';
  if (!isHour(team.last)) return 'last';
  return portsOf(team).every((port) => code.test(port)) ? undefined : 'ports';
}

/** What a team states of itself, in a line. */
export function teamInWords(team: FirmTeam): string {
  const t = text.teams;
  const { first_hour: first, last_hour: last, working_days, licences, ports } = team;
  const given = <T>(value: T | null | undefined): value is T =>
    value !== null && value !== undefined;
  const parts = [
    given(first) ? t.from(clock(first)) : '',
    given(last) ? t.until(clock(last)) : '',
    given(working_days) ? working_days.map((day) => text.firms.day[day] ?? day).join(', ') : '',
    given(licences) ? t.licences(licences.join(', ')) : '',
    given(ports) ? t.ports(ports.join(', ')) : '',
  ];
  return parts.filter((part) => part !== '').join(' · ') || t.asTerms;
}
