/**
 * How an order stands for whoever works at the binnacle: as the server last said, and
 * beyond that by what is waiting to be sent. Pure.
 *
 * What always holds: a step counts as done ahead of the server only where the compass
 * read as expected, by the same rule as the server's; anything else waits for it.
 */

import type { CorrectorPlan, PlanOffer, PlanStep, WorkOrder } from '../api/types';
import type { Write } from './writes';

export interface Ahead {
  state: string;
  plan: CorrectorPlan | null;
  stepsDone: number;
  /** The step to do now. */
  next: PlanStep | null;
  /** What the compass read last. */
  compassDeg: number | null;
  /** What the server has to answer before anything else can be done. */
  waitingFor:
    'as_found' | 'reading' | 'plan' | 'step' | 'settings' | 'second_reading' | 'completion' | null;
}

/** An angle in (−180°, 180°]. */
export function wrapped(degrees: number): number {
  const turn = ((degrees % 360) + 360) % 360;
  return turn > 180 ? turn - 360 : turn;
}

/** By how much the compass turned other than expected, degrees. */
export function offBy(step: PlanStep, beforeDeg: number, afterDeg: number): number {
  return wrapped(wrapped(afterDeg - beforeDeg) - step.change_deg);
}

/** Whether a step did what was expected. */
export function isAsExpected(step: PlanStep, beforeDeg: number, afterDeg: number): boolean {
  return Math.abs(offBy(step, beforeDeg, afterDeg)) <= step.tolerance_deg;
}

/** What the compass should read after a step, from what it reads now. */
export function expectedDeg(step: PlanStep, compassDeg: number | null): number {
  if (compassDeg === null) return step.expected_compass_deg;
  return (((compassDeg + step.change_deg) % 360) + 360) % 360;
}

export function ahead(order: WorkOrder, writes: Write[], offer?: PlanOffer): Ahead {
  let now: Ahead = {
    state: order.state,
    plan: order.plan?.plan ?? null,
    stepsDone: order.steps_done,
    next: order.next_step,
    compassDeg: order.compass_deg,
    waitingFor: null,
  };
  for (const write of writes) {
    if (write.order !== order.id || write.refused) continue;
    now = after(now, write, offer);
    if (now.waitingFor) break;
  }
  return now;
}

function after(now: Ahead, { content }: Write, offer?: PlanOffer): Ahead {
  switch (content.kind) {
    case 'photo':
    case 'remark':
      return now;
    case 'on_board':
      return { ...now, state: 'on_board' };
    case 'plan': {
      const plan = offer?.plans[content.plan - 1];
      if (!plan) return { ...now, waitingFor: 'plan' };
      const next = plan.steps[0] ?? null;
      return { ...now, state: 'adjusting', plan, stepsDone: 0, next };
    }
    case 'step': {
      const before = content.body.before_deg ?? now.compassDeg;
      const { next, plan } = now;
      const fits = next?.number === content.number && before !== null;
      if (!fits || !isAsExpected(next, before, content.body.after_deg)) {
        return { ...now, waitingFor: 'step' };
      }
      const stepsDone = now.stepsDone + 1;
      return {
        ...now,
        stepsDone,
        next: plan?.steps[stepsDone] ?? null,
        compassDeg: content.body.after_deg,
      };
    }
    case 'as_found':
    case 'reading':
    case 'settings':
    case 'second_reading':
    case 'completion':
      return { ...now, waitingFor: content.kind };
  }
}
