/** What people need to know of an order's state. Pure. */

import type { WorkOrderCallFit, WorkOrderState, WorkOrderSummary } from '../api/types';
import * as text from '../text';

/** States in which nothing is left to be done. */
const done = ['closed', 'closed_unverified', 'cancelled'];
/** States before anything was done at the berth. */
const beforeBerth = ['planned', 'offered', 'proposed', 'declined', 'accepted', 'on_board'];
/** States before the work at the binnacle is finished. */
const underWay = [...beforeBerth, 'measured', 'adjusting'];
/** States in which the adjuster works at the binnacle. */
const atBinnacle = ['planned', 'accepted', 'on_board', 'measured', 'adjusting'];

export const isOpen = (state: string): boolean => !done.includes(state);
export const isBeforeBerth = (state: string): boolean => beforeBerth.includes(state);
export const isUnderWay = (state: string): boolean => underWay.includes(state);
export const isAtBinnacle = (state: string): boolean => atBinnacle.includes(state);
export const mayBeCancelled = (state: string): boolean => isUnderWay(state);
export const mayBeOffered = (state: string): boolean => state === 'planned' || state === 'declined';
export const mayBeClosed = (state: string): boolean => state === 'verified' || state === 'failed';
export const mayBeClosedUnverified = (state: string): boolean => state === 'adjusted';

/** States in which the next step is the operator's: to offer it, to answer, to ask again. */
const ofOperator = ['planned', 'proposed', 'declined', 'failed'] as const;
export type OperatorState = (typeof ofOperator)[number];
export const waitsForOperator = (state: string): state is OperatorState =>
  ofOperator.some((one) => one === state);

/** A state's name; one that is new here is shown as the server calls it. */
export function stateName(state: string): string {
  return text.orders.state[state as WorkOrderState] ?? state.replaceAll('_', ' ');
}

/** What comes next, for whoever watches. */
export function whatNext(state: string, reader: 'operator' | 'firm' = 'operator'): string {
  const { next, nextForFirm } = text.orders;
  const theirs = reader === 'firm' ? nextForFirm[state as WorkOrderState] : undefined;
  return theirs ?? next[state as WorkOrderState] ?? '';
}

export function tone(state: string): 'good' | 'notable' | 'bad' | 'plain' {
  if (state === 'failed') return 'bad';
  if (state === 'verified') return 'good';
  if (state === 'adjusting' || state === 'measured' || state === 'proposed') return 'notable';
  return 'plain';
}

/** How loudly to tell of a port call that moved. */
export const callTone = (fit: WorkOrderCallFit): 'plain' | 'notable' =>
  fit === 'fits' ? 'plain' : 'notable';

/** What a moved port call asks of an order, in a word; empty where it asks nothing. */
export function callNeeds({ call_fit, state }: WorkOrderSummary): string {
  if (call_fit === null || call_fit === 'fits' || !isUnderWay(state)) return '';
  return text.offers.call.needs[call_fit];
}

/** Open orders by the day they are planned for, then those that are done, the newest first. */
export function inOrder(orders: WorkOrderSummary[]): WorkOrderSummary[] {
  const open = orders.filter((order) => isOpen(order.state));
  const rest = orders.filter((order) => !isOpen(order.state));
  open.sort((a, b) => a.planned_at.localeCompare(b.planned_at));
  rest.sort((a, b) => b.planned_at.localeCompare(a.planned_at));
  return [...open, ...rest];
}
