/** The calls about reports, and where a report is as a file. */

import { answer, client } from './client';
import type { ReportSettings } from './types';

/** The days, as `2026-11-01`, in which jobs are counted. */
export interface Span {
  from: string;
  to: string;
}

export const findReport = (span: Span) =>
  answer(client.GET('/api/v1/reports/fleet', { params: { query: { ...span } } }));

export const findReportSettings = () => answer(client.GET('/api/v1/reports/settings'));

export const setReportSettings = (body: ReportSettings) =>
  answer(client.PUT('/api/v1/reports/settings', { body }));

export const reportPdf = (span: Span): string => address('pdf', span);

export const reportCsv = (span: Span, table: 'due' | 'deviation' | 'jobs'): string =>
  address('csv', { ...span, table });

const address = (form: 'pdf' | 'csv', query: Span & { table?: string }): string =>
  `/api/v1/reports/fleet.${form}?${new URLSearchParams({ ...query }).toString()}`;
