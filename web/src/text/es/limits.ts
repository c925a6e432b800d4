import type * as en from '../limits';
import type { Translation } from './translation';

export const limits: Translation<typeof en.limits> = {
  title: 'Límites de alerta y ajustes',
  lead: 'A partir de cuándo hay alertas de este buque, cómo se leen sus muestras y cómo las toman sus agentes.',
  parts: {
    alerts: 'Alertas',
    analysis: 'Cómo se leen las muestras',
    agent: 'Cómo toman y envían muestras los agentes',
  },
  notes: {
    alerts:
      'Un Estado de abanderamiento puede exigir menos: AMSA y las Islas Marshall hacen compensar la aguja por encima de 5° a cualquier rumbo.',
    analysis: 'Un cambio hace analizar de nuevo todas sus muestras.',
    agent: 'Los agentes lo siguen con el próximo mensaje de tierra.',
  },
  fields: {
    deviation_deg: ['Desvío, °', 'Se emite una alerta cuando el desvío previsto es mayor.'],
    band95_deg: [
      'Incertidumbre, ± °',
      'Se emite una alerta cuando la banda del 95 % es más ancha a cada lado.',
    ],
    silent_days: [
      'Silencio, días',
      'Se emite una alerta cuando el buque lleva más tiempo sin enviar nada.',
    ],
    reference_constant_sd_deg: [
      'Error constante de una referencia, °',
      'Desviación típica de lo que la giroscópica o el compás satelital se apartan siempre.',
    ],
    min_sog_kn: ['Velocidad mínima sobre el fondo, kn', 'Más despacio no se toman muestras.'],
    max_rate_of_turn_deg_min: [
      'Velocidad máxima de giro, ° por minuto',
      'Girando más deprisa no se toman muestras.',
    ],
    settle_s: [
      'Reposo tras un giro, s',
      'Durante este tiempo no se toman muestras, hasta que la giroscópica está estable.',
    ],
    max_swing_deg: ['Oscilación máxima del rumbo, °', 'A cada lado en 30 s.'],
    sample_s: ['Muestra más larga, s', 'Una muestra es la media de este tiempo como máximo.'],
    seal_s: [
      'Se envía al cabo de, h',
      'Lo muestreado se envía cuando su primera muestra tiene esta antigüedad.',
    ],
  },
  usual: (range, usual) => `${range}; lo habitual es ${usual}.`,
  range: (low, high) => `${low} a ${high}`,
  fieldModel: 'Modelo del campo terrestre',
  fieldModels: { igrf14: 'IGRF-14 (1900 a 2030)', wmm2025: 'WMM2025 (2025 a 2030)' },
  gyro: 'Error de velocidad de la giroscópica',
  gyros: {
    corrected: 'La giroscópica lo elimina ella misma',
    uncorrected: 'La giroscópica no lo elimina: lo hace el análisis',
  },
  more: 'Cómo se toman y se leen las muestras',
  change: 'Cambiar los ajustes',
  save: 'Guardar los ajustes',
  saving: 'Guardando…',
  saved: 'Los ajustes están guardados.',
  wrong: (field, range, whole) =>
    `«${field}» es ${whole ? 'un número entero' : 'un número'} de ${range}.`,
};
