import type * as en from '../offers';
import type { Translation } from './translation';

export const offers: Translation<typeof en.offers> = {
  title: 'Empresas',
  lead: 'A quién se ha pedido y qué ha respondido.',
  leadOfYours: 'Lo que el operador pide a la empresa.',
  none: 'No está ofrecida a ninguna empresa. Puede hacerla el personal del buque, u ofrecerse a empresas con las que se trabaja.',
  toYou: 'Del operador',
  state: {
    waiting: 'todavía no le toca',
    open: 'consultada',
    proposed: 'propone otras condiciones',
    accepted: 'la tiene',
    declined: 'la rechazó',
    lapsed: 'no respondió a tiempo',
    withdrawn: 'retirada',
  },
  ofYours: {
    open: 'está ofrecida a la empresa',
    proposed: 'el operador todavía no ha respondido a la propuesta',
    accepted: 'la tiene la empresa',
  },
  answerBy: (when) => `respuesta antes de ${when}`,
  terms: {
    when: 'Cuándo',
    berth: 'Atraque',
    fee: 'Honorarios',
    euros: (fee) => `${fee} €`,
    offered: (fee) => `Ofrecida por ${fee}, sin contar el desplazamiento`,
    team: (name) => `Equipo ${name}`,
  },

  call: {
    title: 'Escala',
    fit: {
      fits: 'La escala ha cambiado y la hora acordada sigue dentro de ella.',
      other_hour:
        'La escala ha cambiado: el día acordado está atracado, pero no desde esa hora. Acordar otra.',
      needs_new_day: 'La escala ha cambiado: acordar otro día.',
      no_call: 'La hora acordada se ha quedado sin escala: acordar otra hora o cancelar la orden.',
    },
    needs: {
      other_hour: 'Escala cambiada: hace falta otra hora',
      needs_new_day: 'Escala cambiada: hace falta otro día',
      no_call: 'Ya no hay escala',
    },
    was: 'Era',
    is: 'Es',
    agreed: 'Acordado',
    withdrawn: 'retirada',
    span: (port, from, to) => `${port}, de ${from} a ${to}`,
  },

  retime: {
    ask: 'Pedir otra hora…',
    submit: 'Preguntar a la empresa',
    asked: 'Se ha pedido otra hora',
    stands: 'Lo acordado vale hasta que la empresa acepte.',
    agree: 'Aceptar la hora nueva',
    disagree: 'Mantener lo acordado',
    takeBack: 'Retirar la petición',
  },

  offer: 'Ofrecer a empresas…',
  submit: 'Ofrecer',
  which: 'Empresas, en el orden en que se les pregunta',
  order: (n, name) => `${n}. ${name}`,
  noFirms:
    'La compañía no trabaja aquí todavía con ninguna empresa. Las registra quien administra este servidor.',
  firmsMissing: 'Elegir una empresa.',
  hours: 'Horas para responder',
  hoursWrong: 'Indicar cuántas horas, de 1 a 720.',
  atOnce: 'Preguntar a todas a la vez: la primera que acepte la tiene',
  say: 'Qué se les dice',

  agree: 'Aceptar',
  agreeTo: (firm) => `Aceptar lo que propone ${firm}`,
  disagree: 'No aceptar',
  disagreeTo: (firm) => `No aceptar lo que propone ${firm}`,
  word: 'Unas palabras para la empresa',

  accept: 'Aceptar',
  adjuster: 'Quién irá',
  licence: 'Número de licencia',
  adjusterMissing: 'Indicar quién irá.',
  propose: 'Proponer otras condiciones…',
  proposeSubmit: 'Proponer',
  planned: 'Desde cuándo, en su lugar',
  until: 'Hasta',
  portTime: 'hora del puerto',
  hoursMissing:
    'Indicar desde cuándo y hasta cuándo: el final, dentro de las 24 horas del principio.',
  berth: 'Atraque, si es otro',
  fee: 'Honorarios en euros',
  feeWrong: 'Los honorarios son una cifra de 0 a 1 000 000.',
  termsMissing: 'Indicar otra hora, otro atraque u otros honorarios.',
  decline: 'Rechazar…',
  declineConfirm: 'Rechazar',
  giveBack: 'Devolver…',
  giveBackConfirm: 'Devolver',
  why: 'Por qué',
  whyMissing: 'Indicar por qué.',
  gone: 'La orden ya no corresponde a la empresa.',
};

export const messages: Translation<typeof en.messages> = {
  title: 'Mensajes',
  lead: 'Entre operador y empresa; ninguna otra empresa los lee.',
  none: 'Todavía no se ha escrito nada.',
  nobody: 'Los mensajes van a una empresa consultada o que tiene la orden.',
  by: (name, firm) => `${name}, ${firm}`,
  to: 'Para',
  toFirm: (firm) => `para ${firm}`,
  label: 'Mensaje',
  send: 'Enviar',
  sending: 'Enviando…',
  missing: 'Escribir algo primero.',
};
