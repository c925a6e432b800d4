/** A firm's terms as they are written in a form, and read from it. Pure. */

import type { FirmTerms } from '../api/types';

export const weekdays = ['Mon', 'Tue', 'Wed', 'Thu', 'Fri', 'Sat', 'Sun'] as const;

export interface Written {
  fee: string;
  extra: string;
  teams: string;
  jobs: string;
  first: string;
  last: string;
  lead: string;
  days: string[];
  ports: string;
  flags: string;
  licences: string;
  closed: string;
}

/** What is wrong: a number that is none, or a line of the ports. */
export type Wrong = { field: keyof Written } | { line: number };

export function writtenAs(terms: FirmTerms | null): Written {
  const of = (value: number | undefined, usual: string) =>
    value === undefined ? usual : String(value);
  return {
    fee: of(terms?.fee_eur, ''),
    extra: of(terms?.extra_compass_eur, '0'),
    teams: of(terms?.teams, '1'),
    jobs: of(terms?.jobs_a_team_day, '1'),
    first: of(terms?.first_hour, '8'),
    last: of(terms?.last_hour, '18'),
    lead: of(terms?.lead_time_h, '0'),
    days: terms?.working_days ?? weekdays.slice(0, 5),
    ports: (terms?.ports ?? []).map((port) => `${port.port} ${port.travel_eur ?? 0}`).join('\n'),
    flags: (terms?.flags ?? []).join(', '),
    licences: (terms?.licences ?? []).join(', '),
    closed: (terms?.closed ?? []).join(', '),
  };
}

export function readTerms(written: Written): FirmTerms | Wrong {
  const numbers = ['fee', 'extra', 'teams', 'jobs', 'first', 'last', 'lead'] as const;
  const wrong = numbers.find((field) => !isNumber(written[field]));
  if (wrong) return { field: wrong };
  const ports: FirmTerms['ports'] = [];
  for (const [n, line] of written.ports.split('\n').entries()) {
    if (line.trim() === '') continue;
    const found = /^\s*([A-Za-z]{2})\s?([A-Za-z2-9]{3})(?:[\s,;]+(\d+(?:\.\d+)?))?\s*$/.exec(line);
    if (!found) return { line: n + 1 };
    const [, country = '', place = '', travel = '0'] = found;
    ports.push({ port: `${country}${place}`.toUpperCase(), travel_eur: Number(travel) });
  }
  return {
    fee_eur: Number(written.fee),
    extra_compass_eur: Number(written.extra),
    teams: Number(written.teams),
    jobs_a_team_day: Number(written.jobs),
    first_hour: Number(written.first),
    last_hour: Number(written.last),
    lead_time_h: Number(written.lead),
    working_days: weekdays.filter((day) => written.days.includes(day)),
    ports,
    flags: list(written.flags).map((flag) => flag.toUpperCase()),
    licences: list(written.licences),
    closed: list(written.closed),
  };
}

const isNumber = (text: string): boolean => text.trim() !== '' && Number(text) >= 0;

export const list = (text: string): string[] =>
  text
    .split(/[,;\n]/)
    .map((part) => part.trim())
    .filter((part) => part !== '');

/** An hour of the day as clocks show it: `07:30`. */
export function clock(hour: number): string {
  const minutes = Math.round(hour * 60);
  const two = (n: number) => String(n).padStart(2, '0');
  return `${two(Math.floor(minutes / 60))}:${two(minutes % 60)}`;
}
