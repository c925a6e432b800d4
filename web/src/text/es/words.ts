import type * as en from '../words';
import type { Translation } from './translation';

export const severity: Translation<typeof en.severity> = {
  notice: 'Aviso',
  warning: 'Advertencia',
  critical: 'Crítica',
};

export const alertCause: Translation<typeof en.alertCause> = {
  deviation_over_limit: 'Desvío por encima del límite',
  reference_fault: 'La giroscópica y el compás satelital discrepan',
  compass_fault: 'La aguja falla',
  lightning_or_shock: 'El magnetismo cambió: rayo o golpe',
  magnetic_cargo: 'El magnetismo cambió: carga magnética',
  drift: 'El magnetismo deriva',
  alignment: 'El cero de la aguja se ha movido',
  local_anomaly: 'Anomalía local',
  magnetic_storm: 'Tormenta magnética',
  berth_steel: 'Acero en el atraque',
  gnss_interference: 'Interferencia GNSS',
  unknown_change: 'El magnetismo cambió: causa desconocida',
  reported_aboard: 'La aguja y la giroscópica se separaron, según el buque',
  silent_agent: 'Sin noticias del buque',
  adjustment_not_confirmed: 'La mar no confirma una compensación',
  agreed_job_at_risk: 'Una compensación acordada ya no encaja',
  cloned_agent: 'Dos ordenadores envían como un solo agente',
  no_model: 'Todavía sin modelo de la aguja',
  wide_band: 'El modelo es demasiado incierto',
};

export const urgency: Translation<typeof en.urgency> = {
  routine: 'Ordinaria',
  unknown: 'No se conoce',
  soon: 'Pronto',
  urgent: 'Urgente',
  overdue: 'Vencida',
};

export const grade: Translation<typeof en.grade> = {
  small: 'pequeño',
  notable: 'notable',
  large: 'grande',
};

export const gradeLong: Translation<typeof en.gradeLong> = {
  small: 'Menos de 3° a todos los rumbos',
  notable: 'Entre 3° y 5° a algún rumbo',
  large: 'Más de 5° a algún rumbo: la mayoría de las banderas exigen compensar',
};
