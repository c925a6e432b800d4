/** Which firms can do a job, and what speaks against the others. Pure functions. */

import type { FirmTeam, FirmTerms, FirmWithTerms } from '../api/types';
import { shownAt, type Zone } from '../zone';
import { clock, weekdays } from './terms';
import * as text from '../text';

/** A job as firms are asked for it; what is not known counts against nobody. */
export interface Job {
  /** UN/LOCODE. */
  port: string | undefined;
  at: string | null;
  /** How long it takes. */
  hours: number;
  /** The port's time; nothing where it is not known. */
  zone: Zone | undefined;
  /** ISO 3166. */
  flag: string | null;
  /** A licence that the adjuster must hold. */
  licence: string | null;
}

export interface Candidate {
  id: string;
  name: string;
  /** With travel where the port is known, euros; nothing where no fee is said. */
  fee: number | null;
  /** What speaks against the firm, in words; nothing where it can do it. */
  against: string[];
}

const hourMs = 3_600_000;

/** All firms, those that can do it first, and of these the cheapest. */
export function candidates(
  firms: readonly FirmWithTerms[],
  job: Job,
  now: Date,
): { able: Candidate[]; others: Candidate[] } {
  const all = firms
    .map((firm) => candidate(firm, job, now))
    .sort((a, b) => (a.fee ?? Infinity) - (b.fee ?? Infinity) || a.name.localeCompare(b.name));
  const isAble = ({ against }: Candidate) => against.length === 0;
  return { able: all.filter(isAble), others: all.filter((one) => !isAble(one)) };
}

function candidate(firm: FirmWithTerms, job: Job, now: Date): Candidate {
  const { firm_id: id, firm_name: name, terms, problems } = firm;
  if (!terms) return { id, name, fee: null, against: [text.newOrder.against.noTerms] };
  const served = terms.ports?.find(({ port }) => port === job.port);
  const fee = terms.fee_eur + (served?.travel_eur ?? 0);
  return { id, name, fee, against: [...problems, ...leastAgainst(firm, terms, job, now)] };
}

/** What speaks against the team that suits best; all are alike where the firm states none. */
function leastAgainst(firm: FirmWithTerms, terms: FirmTerms, job: Job, now: Date): string[] {
  const teams = firm.teams.length > 0 ? firm.teams.map((team) => ofTeam(terms, team)) : [terms];
  const found = teams.map((one) => against(one, job, now));
  return found.sort((a, b) => a.length - b.length)[0] ?? [];
}

/** The firm's terms with what a team states of itself. */
function ofTeam(terms: FirmTerms, team: FirmTeam): FirmTerms {
  const { first_hour, last_hour, working_days, licences, ports } = team;
  const served = terms.ports?.filter(({ port }) => !ports || ports.includes(port)) ?? [];
  return {
    ...terms,
    ports: served,
    ...(typeof first_hour === 'number' ? { first_hour } : {}),
    ...(typeof last_hour === 'number' ? { last_hour } : {}),
    ...(working_days ? { working_days } : {}),
    ...(licences ? { licences } : {}),
  };
}

function against(terms: FirmTerms, job: Job, now: Date): string[] {
  const t = text.newOrder.against;
  const { ports, flags, licences } = terms;
  const found: string[] = [];
  if (job.port !== undefined && !ports?.some(({ port }) => port === job.port)) found.push(t.port);
  if (job.flag !== null && flags?.length && !flags.includes(job.flag)) found.push(t.flag(job.flag));
  if (job.licence !== null && !licences?.includes(job.licence)) found.push(t.licence(job.licence));
  if (job.at === null) return found;
  if (job.zone !== undefined) found.push(...againstHours(terms, job, job.at, job.zone));
  const lead = terms.lead_time_h ?? 0;
  if (Date.parse(job.at) - now.getTime() < lead * hourMs) found.push(t.lead(lead));
  return found;
}

function againstHours(terms: FirmTerms, job: Job, at: string, zone: Zone): string[] {
  const t = text.newOrder.against;
  const there = shownAt(Date.parse(at), zone);
  const day = weekdays[(there.getUTCDay() + 6) % 7] ?? 'Mon';
  const hour = there.getUTCHours() + there.getUTCMinutes() / 60;
  const ends = hour + job.hours;
  const [first, last] = [terms.first_hour ?? 8, terms.last_hour ?? 18];
  const working = terms.working_days ?? weekdays.slice(0, 5);
  const found: string[] = [];
  if (!working.includes(day)) found.push(t.day(text.firms.day[day] ?? day));
  if (terms.closed?.includes(there.toISOString().slice(0, 10))) found.push(t.closed);
  if (hour < first || ends > last) found.push(t.hours(clock(first), clock(last)));
  return found;
}
