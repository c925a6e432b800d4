import type * as en from '../reports';
import type { Translation } from './translation';

export const reports: Translation<typeof en.reports> = {
  title: 'Informes',
  lead: (fleet, vessels, compasses) =>
    `${fleet}: ${vessels} ${vessels === 1 ? 'buque' : 'buques'}, ${compasses} ${compasses === 1 ? 'aguja' : 'agujas'}`,
  from: 'Desde',
  to: 'Hasta, incluido',
  show: 'Mostrar',
  wrongSpan: 'El primer día no puede ser posterior al último.',
  pdf: 'PDF',
  csv: 'CSV',
  csvOf: (table) => `${table} en CSV`,
  vessel: 'Buque',
  compass: 'Aguja',
  predicted: 'Previsto a partir de rumbos en la mar. No es un certificado.',

  saved: {
    title: 'Ahorro frente al giro de compensación',
    lead: (swing, hours) =>
      `Un giro de compensación se calcula en ${swing} y ${hours} horas. Se ahorra uno por todas las agujas de un buque en cada visita; se descuentan los honorarios de todos los trabajos.`,
    jobs: 'Compensadas sin girar el buque',
    money: 'Ahorrado',
    hours: 'Horas de buque ahorradas',
    fees: 'Honorarios',
    withoutFee: (jobs) =>
      `No se conocen los honorarios de ${jobs === 1 ? 'un trabajo' : `${jobs} trabajos`}: la cifra los cuenta de más.`,
  },

  due: {
    title: 'Vencimientos',
    none: 'Ninguna aguja vence en un día conocido.',
    on: 'Vence',
    why: 'Por qué',
    last: 'Última compensación',
    order: 'En curso',
    never: 'no consta',
    nothing: '–',
  },

  deviation: {
    title: 'Mayor desvío',
    lead: 'Donde se hizo cada modelo, a día de hoy.',
    none: 'No hay agujas.',
    deviation: 'Desvío',
    band: 'Banda del 95 %',
    heading: 'A rumbo (Ra)',
    until: 'Última muestra',
    noModel: 'todavía sin modelo',
  },

  jobs: {
    title: 'Compensadas',
    none: 'En este periodo no se compensó nada.',
    day: 'Día',
    port: 'Puerto',
    firm: 'Empresa',
    state: 'Estado',
    fee: 'Honorarios',
    own: 'el propio operador',
    byTerms: 'según sus condiciones',
  },

  settings: {
    title: 'Con qué se calcula y quién lo recibe cada mes',
    lead: 'El informe de un mes se envía por correo el día uno del siguiente.',
    swing: 'Un giro de compensación cuesta, €',
    hours: 'Un giro de compensación dura, horas',
    monthly: 'Cada mes a (una dirección por línea, 20 como máximo)',
    submit: 'Guardar',
    busy: 'Guardando…',
    done: 'Guardado.',
    wrong: (field) => `No es un número: ${field}.`,
  },
};
