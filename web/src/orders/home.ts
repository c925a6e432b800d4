/** An adjuster's orders by what is to be done about them. Pure. */

import type { WorkOrderSummary } from '../api/types';
import { ahead } from './ahead';
import { isOpen } from './order';
import type { Kept } from './shelf';
import type { Write } from './writes';

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

/** How an order stands on this device, for whoever has no connection. */
export interface OnDevice {
  order: WorkOrderSummary;
  /** When it was last seen. */
  at: string;
  /** How much was done since that the server does not know. */
  waiting: number;
}

/** What is kept for a reader, with what is waiting to be sent. */
export function onDevice(
  kept: readonly Kept[],
  writes: readonly Write[],
  user: string | undefined,
): OnDevice[] {
  return kept
    .filter((one) => one.user === user)
    .map(({ id, order, offer, at }) => {
      const hers = writes.filter((write) => write.order === id);
      const state = ahead(order, hers, offer).state as WorkOrderSummary['state'];
      return { order: { ...order, state }, at, waiting: hers.filter((w) => !w.refused).length };
    });
}

/** Whether what is kept of an order is not what the server has: it is fetched anew. */
export const isToKeep = (
  order: WorkOrderSummary,
  kept: readonly Kept[],
  user: string | undefined,
): boolean =>
  !kept.some(
    (one) => one.id === order.id && one.user === user && one.order.last_seq >= order.last_seq,
  );
