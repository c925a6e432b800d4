import type * as en from '../alerts';
import type { Translation } from './translation';

export const alerts: Translation<typeof en.alerts> = {
  lead: 'Lo que alguien debe saber o resolver. Una alerta se cierra sola cuando cesa su causa.',
  unacknowledged: (n) => (n === 0 ? 'reconocidas' : `${n} sin reconocer`),
  emptyTitle: 'Nada que atender',
  empty: 'Ningún buque tiene alertas abiertas.',
  since: (when) => `desde ${when}`,
  todo: 'Qué hacer',
  evidence: 'Qué lo demuestra',
  acknowledged: (who, when) => `Reconocida por ${who}, ${when}`,
  cleared: (who, when) =>
    who === null ? `Terminada desde ${when}` : `Cerrada por ${who}, ${when}`,
  ordered: (port, on) => `Compensación encargada: ${port}, ${on}`,
  acknowledge: 'Reconocer',
  note: 'Nota',
  clear: 'Cerrar',
  clearReason: 'Por qué ha terminado',
  clearMissing: 'Indicar por qué ha terminado.',
  confirmAcknowledge: 'Reconocer la alerta',
  confirmClear: 'Cerrar la alerta',
  saidAcknowledged: 'La alerta está reconocida.',
  saidCleared: 'La alerta está cerrada.',
  handling: {
    assigned: (name) => `Asignada a ${name}`,
    unassigned: 'Sin asignar',
    assign: 'Asignármela',
    unassign: 'Dejar de tenerla asignada',
    snoozed: (until) => `pospuesta hasta ${until}`,
    snooze: (days) =>
      days === 1 ? 'Posponer un día' : days === 7 ? 'Posponer una semana' : `Posponer ${days} días`,
    wake: 'Dejar de posponer',
    comments: 'Comentarios',
    none: 'Todavía no hay comentarios.',
    comment: 'Comentario',
    commentMissing: 'Escribir un comentario.',
    say: 'Añadir el comentario',
    said: {
      assigned: 'La alerta queda asignada a quien la consulta.',
      unassigned: 'La alerta queda sin asignar.',
      snoozed: 'La alerta está pospuesta.',
      woken: 'La alerta ya no está pospuesta.',
    },
  },
  acknowledgeAll: (n, raised) =>
    n === raised ? `Reconocer las ${n}` : `Reconocer las ${n} primeras de ${raised}`,
  acknowledgeAllSure: 'Las alertas siguen en la lista, con sus causas, como reconocidas.',
  saidAllAcknowledged: (n) =>
    n === 1 ? '1 alerta está reconocida.' : `${n} alertas están reconocidas.`,
  filter: {
    search: 'Buque',
    searchHint: 'Nombre del buque o de la aguja',
    state: 'Estado',
    anyState: 'Abiertas',
    states: {
      raised: 'Sin reconocer',
      acknowledged: 'Reconocidas',
      mine: 'Asignadas a mí',
      snoozed: 'Pospuestas',
    },
    severity: 'Gravedad',
    anySeverity: 'Cualquier gravedad',
    cause: 'Causa',
    anyCause: 'Cualquier causa',
    shown: (n, all) =>
      n === all
        ? n === 1
          ? '1 alerta abierta'
          : `${n} alertas abiertas`
        : `${n} de ${all} alertas abiertas`,
    criticalHidden: (n) => (n === 1 ? '1 crítica no se muestra' : `${n} críticas no se muestran`),
    noneTitle: 'No hay coincidencias',
    none: (all) =>
      all === 1
        ? 'Ninguna alerta abierta coincide. Hay una: cambiar lo que se busca o mostrarla.'
        : `Ninguna alerta abierta coincide. Hay ${all}: cambiar lo que se busca o mostrarlas todas.`,
    reset: 'Mostrar todas las alertas',
  },
  noSuch: 'La alerta del enlace no está abierta ni entre las cerradas últimamente.',
  clearedTitle: 'Cerradas últimamente',
  toMail: 'Correo',
  toWebhooks: 'Webhooks',
  toNotifications: 'Notificaciones',
};
