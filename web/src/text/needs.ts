/** Why somebody should look at a vessel. */

import { translate } from './language';

export const needs = translate('needs', {
  title: 'Needs',
  unknown: (why: string) => `What is needed could not be found out in full: ${why}`,
  alerts: 'Open alerts',
  noAlerts: 'none',
  notKnown: 'not known yet',
  moreAlerts: (n: number) => (n === 1 ? 'and 1 more' : `and ${n} more`),
  due: 'Next adjustment due',
  noDue: 'nothing is due',
  toSchedule: 'Schedule',
  /** What the schedule has for a compass that is due. */
  proposed: (day: string, port: string, firm: string) => `Proposed: ${day}, ${port}, ${firm}`,
  inHand: (day: string, port: string, firm: string) => `In hand: ${day}, ${port}, ${firm}`,
  notScheduled: 'Not scheduled: why',
  call: 'Next port call',
  noCall: 'none is known',
  worstThere: (angle: string, on: string) => `up to ${angle} there, on ${on}`,
  order: 'Work order',
  noOrder: 'none is open',
});
