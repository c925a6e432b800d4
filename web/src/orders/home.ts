/** An adjuster's orders by what is to be done about them. Pure. */

import type { WorkOrderSummary } from '../api/types';
import { isOpen } from './order';

export interface Groups {
  today: WorkOrderSummary[];
  answer: WorkOrderSummary[];
  coming: WorkOrderSummary[];
  done: WorkOrderSummary[];
}

/** States in which someone of the firm is at the binnacle, whatever the day. */
const onBoard = ['on_board', 'measured', 'adjusting'];
const toAnswer = ['offered', 'proposed'];
const mostDone = 10;

/**
 * Today's are those that are planned for this day by the reader's own clock, and those that
 * are being done. What was to be done on an earlier day and is not comes with them.
 */
export function grouped(orders: readonly WorkOrderSummary[], now: Date): Groups {
  const tomorrow = new Date(now.getFullYear(), now.getMonth(), now.getDate() + 1);
  const groups: Groups = { today: [], answer: [], coming: [], done: [] };
  for (const order of orders) groups[groupOf(order, tomorrow)].push(order);
  for (const group of [groups.today, groups.answer, groups.coming]) {
    group.sort((a, b) => a.planned_at.localeCompare(b.planned_at));
  }
  groups.done.sort((a, b) => b.planned_at.localeCompare(a.planned_at));
  groups.done = groups.done.slice(0, mostDone);
  return groups;
}

function groupOf(order: WorkOrderSummary, tomorrow: Date): keyof Groups {
  if (toAnswer.includes(order.state)) return 'answer';
  if (onBoard.includes(order.state)) return 'today';
  if (!isOpen(order.state) || order.completed_at !== null) return 'done';
  return Date.parse(order.planned_at) < tomorrow.getTime() ? 'today' : 'coming';
}
