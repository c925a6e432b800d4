import type * as en from '../needs';
import type { Translation } from './translation';

export const needs: Translation<typeof en.needs> = {
  title: 'Qué necesita',
  unknown: (why) => `No se ha podido averiguar del todo qué necesita: ${why}`,
  alerts: 'Alertas abiertas',
  noAlerts: 'ninguna',
  notKnown: 'todavía no se sabe',
  moreAlerts: (n) => `y ${n} más`,
  due: 'Vence la próxima compensación',
  noDue: 'nada vence',
  toSchedule: 'Planificación',
  proposed: (day, port, firm) => `Propuesta: ${day}, ${port}, ${firm}`,
  inHand: (day, port, firm) => `En curso: ${day}, ${port}, ${firm}`,
  notScheduled: 'Sin planificar: por qué',
  call: 'Próxima escala',
  noCall: 'no se conoce ninguna',
  worstThere: (angle, on) => `allí hasta ${angle}, a ${on}`,
  order: 'Orden de trabajo',
  noOrder: 'ninguna abierta',
};
