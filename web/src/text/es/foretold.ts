import type * as en from '../foretold';
import type { Translation } from './translation';

export const foretold: Translation<typeof en.foretold> = {
  anOrder: 'una orden de trabajo',
  order: (port, day) => `la orden de trabajo ${port}, ${day}`,
  proof: {
    none: 'Previsto, sin verificar en la mar',
    verified: 'Previsto y verificado en la mar',
    disproved: 'Previsto y no confirmado en la mar',
  },
  origin: (order, day, place) =>
    `Esta curva está prevista por ${order}, a partir del trabajo hecho el ${day} en ${place}. No se ha ajustado a ninguna muestra.`,
  noHeading: 'No ha llegado ningún rumbo estable desde la compensación.',
  needed: (agree, more, best) =>
    `${agree === 1 ? '1 rumbo coincide' : `${agree} rumbos coinciden`} hasta ahora; ${more === 1 ? 'hace' : 'hacen'} falta ${more} más${best === '' ? '' : `, a ser posible a ${best}`}.`,
  toOrder: 'La orden',
  shortOf: {
    none: 'previsto, sin verificar en la mar',
    verified: 'previsto, verificado en la mar',
    disproved: 'previsto, no confirmado en la mar',
  },
  noResiduals: (order) => `ninguno: previsto por ${order}, sin ajustar a muestras`,
  modelLine: (version, day) => `Modelo ${version}, previsto ${day}`,
  worstThere: 'Mayor desvío donde se compensó',
  worthTitle: 'Muestras desde la compensación',
  worthNone: 'Ninguna',
  worthNoneLong:
    'No se ha medido nada desde entonces: la banda es la del modelo anterior, de la lectura en el atraque y de los correctores que se movieron.',
  worth: (until) =>
    `Contrastadas con lo previsto; la última de ${until}. Dicen si se cumple; la curva no se ajusta a ellas.`,
};
