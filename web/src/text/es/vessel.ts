import type * as en from '../vessel';
import type { Translation } from './translation';

export const vessel: Translation<typeof en.vessel> = {
  back: 'Flota',
  callSign: 'Indicativo de llamada',
  flag: 'Bandera',
  compass: 'Aguja',
  worst: 'Mayor desvío',
  rms: 'Residuos',
  rmsHelp: (used, rejected) => `rms de ${used} muestras; ${rejected} fuera`,
  lastUpload: 'Último envío',
  lastPosition: 'Última posición',
  fieldHelp: (h, z) => `${h} horizontal, ${z} vertical`,
  fieldAt: (place) => `en ${place}`,
  variation: 'Declinación',
  modelLine: (version, until) => `Modelo ${version}, datos hasta ${until}`,
  noModelTitle: 'Todavía sin modelo',
  noModelLead: 'Esto es lo que falta ahora:',
  noModelHow:
    'La navegación ordinaria lo aporta: el agente guarda cada tramo en que el buque mantiene un rumbo estable con velocidad, lejos del atraque.',
};

export const vesselTabsLabel = 'Sobre el buque';
export const vesselTabs: Translation<typeof en.vesselTabs> = {
  overview: 'Resumen',
  deviation: 'Desvío',
  changes: 'Cambios',
  adjustment: 'Compensación',
  agent: 'Agente',
  settings: 'Ajustes',
};

export const vesselPanelsLabel = 'En esta página';
export const vesselPanels: Translation<typeof en.vesselPanels> = {
  deviation: 'Curva y tabla',
  card: 'Tablilla',
  book: 'Libro de desvíos',
  trust: 'Confianza',
  azimuths: 'Azimutes',
  coverage: 'Cobertura',
  parameters: 'Magnetismo',
  coefficients: 'Coeficientes',
  history: 'En el tiempo',
  changes: 'Qué ha cambiado',
  logbook: 'Diario',
  residuals: 'Residuos',
  orders: 'Órdenes de trabajo',
  binnacle: 'Bitácora',
  agents: 'A bordo',
  enrol: 'Alta',
  particulars: 'Características',
  limits: 'Límites',
};

export const now: Translation<typeof en.now> = {
  finding: 'Averiguando qué hacer…',
  unknown: 'Todavía no se sabe',
  unknownWhy: 'No han llegado todas las alertas, vencimientos y órdenes de trabajo de este buque.',
  nothing: 'Nada que hacer ahora',
  nothingDue: 'Ninguna alerta pide nada, ninguna compensación vence y no hay órdenes en curso.',
  dueLater: (on) => `Ninguna alerta pide nada. La próxima compensación vence el ${on}.`,
  snoozed: (n) => (n === 1 ? 'Una alerta está pospuesta.' : `${n} alertas están pospuestas.`),
  notRecorded: 'No consta ninguna compensación',
  toStart: 'Anotar la fecha',
  openAlert: 'Abrir la alerta',
  seeChange: 'Antes y después',
  openOrder: 'Abrir la orden de trabajo',
  order: (state, port, on) => `${state}: ${port}, ${on}`,
  overdue: (on) => `Compensación vencida desde ${on}`,
  dueBy: (on) => `La compensación vence el ${on}`,
  toSchedule: 'Ver la planificación',
  noAgent: 'Todavía sin datos de un agente',
  noAgentWhy:
    'El agente a bordo registra la aguja y envía aquí los datos. Se da de alta con un código que se introduce a bordo.',
  noModel: 'El agente está reuniendo muestras',
  noModelWhy:
    'La primera curva de desvíos llega tras unos días de navegación a rumbos distintos. Hasta entonces no hay nada que hacer.',
  toAgent: 'Ver el agente',
};

export const history: Translation<typeof en.history> = {
  title: 'Desvío a lo largo del tiempo',
  lead: 'El desvío a cada rumbo, como si el buque hubiera estado siempre en la última posición. Un cambio de su magnetismo es un escalón; las bandas sombreadas son del 95 %.',
  headings: 'Rumbos',
  most: (n) => `Como máximo ${n} a la vez: quitar uno para dibujar otro.`,
  none: 'Todavía sin curva: necesita un modelo.',
  noCurve: 'sin curva',
  summary: (headings, from, to, steps) =>
    `Desvío a ${headings}, de ${from} a ${to}, con ${steps === 1 ? 'un cambio' : `${steps} cambios`}. La tabla de abajo tiene las cifras.`,
  axisY: 'Desvío',
  table: 'El desvío en una tabla',
  caption: 'Desvío a cada rumbo por época',
  from: 'Desde',
  until: 'Hasta',
  now: 'ahora',
  start: 'el principio',
  sample: 'Muestra a menos de 15° del rumbo',
  epoch: 'Desvío por época',
  change: 'Cambio del magnetismo del buque',
  passing: 'Tormenta, carga u otra perturbación',
};

export const agents: Translation<typeof en.agents> = {
  title: 'A bordo',
  lead: 'Cada instalación del agente comunica una aguja como un flujo de datos.',
  none: 'Todavía no se ha dado de alta ningún agente para este buque.',
  stream: 'Flujo',
  version: (v) => `agente ${v}`,
  opened: 'De alta',
  lastUpload: 'Último envío',
  batches: 'Lotes',
  samples: 'Muestras',
  waiting: 'esperando el primer lote',
  lastWeek: 'Enlace, últimos 7 días',
  sent: (batches, octets) => `${batches} lotes, ${octets} bytes`,
  silent: 'no llegó nada',
  longestWait: 'Espera más larga del enlace',
  spool: 'En espera a bordo',
  spoolEmpty: 'nada',
  spoolHolds: (batches) => (batches === '1' ? '1 lote' : `${batches} lotes`),
  notYetSaid: 'no se sabe antes del primer lote',
  notCarried: 'no se sabe: no lo dicen los envíos cortos ni los agentes antiguos',
  budget: 'Presupuesto del enlace',
  budgetEnough: 'no escasea',
  budgetLeft: (percent) => `queda ${percent} del de un día`,
  budgetOver: (percent) => `excedido en ${percent} del de un día`,
  asOf: (when) => `a fecha de ${when}`,
  notSaidSince: (when) =>
    `a fecha de ${when}; lo que llegó después no lo decía, como los envíos cortos`,
  gap: 'Falta un lote anterior al último; el agente lo envía de nuevo.',
  revoked: (when) =>
    `Revocado ${when}: este agente no puede enviar hasta que se dé de alta de nuevo.`,
  revoke: 'Revocar…',
  revokeQuestion:
    'No puede enviar nada más hasta que se dé de alta de nuevo con otro código. Sigue tomando muestras, y lo que ha enviado se conserva.',
  revokeConfirm: 'Revocar el agente',
  tally: 'Qué fue de las ventanas de diez segundos',
  tallyNone: 'Todavía no se han comunicado ventanas.',
  windows: 'Ventanas',
  share: 'Parte',
  outcome: 'Resultado',
  reasons: {
    accepted: 'aceptada',
    hold_berthed: 'rechazada: atracado (pausa de la tripulación)',
    hold_magnetic_cargo: 'rechazada: carga magnética (pausa de la tripulación)',
    hold_degaussing: 'rechazada: desmagnetización (pausa de la tripulación)',
    clock: 'rechazada: el reloj del buque dio un salto',
    no_time: 'rechazada: sin hora',
    no_compass: 'rechazada: sin rumbo de aguja',
    no_reference: 'rechazada: sin giroscópica ni compás satelital',
    not_independent: 'rechazada: la referencia procede de la propia aguja',
    unproven_reference:
      'rechazada: todavía no está demostrado que la referencia sea independiente de la aguja',
    two_sensors: 'rechazada: dos sensores envían como uno',
    gnss_interference: 'rechazada: interferencia GNSS, y sin giroscópica',
    no_position: 'rechazada: sin posición',
    no_speed: 'rechazada: sin velocidad sobre el fondo',
    sparse: 'rechazada: muy pocas lecturas',
    slow: 'rechazada: demasiado lento',
    turning: 'rechazada: girando',
    settling: 'rechazada: estabilizándose tras un giro',
    swinging: 'rechazada: rumbo oscilante',
    thinned: 'aceptada, y después descartada por falta de espacio o presupuesto',
  },
  otherReason: (name) => `rechazada: ${name.replaceAll('_', ' ')}`,
};

export const enrol: Translation<typeof en.enrol> = {
  title: 'Dar de alta un agente',
  lead: 'Crea un código que un agente a bordo canjea por su propia clave.',
  compass: 'Para la aguja',
  make: 'Crear un código',
  making: 'Creando…',
  shownOnce: 'Se muestra solo ahora. Vale una vez, hasta',
  onBoard: 'A bordo, escribir:',
  another: 'Crear otro código',
  qr: 'Código QR con la orden que hay que escribir a bordo',
};

export const orderPanel: Translation<typeof en.orderPanel> = {
  title: 'Compensación',
  lead: 'Órdenes de trabajo de esta aguja.',
  none: 'No hay ninguna compensación en curso.',
  order: 'Encargar una compensación',
};
