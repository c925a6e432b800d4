/** Words for what the server names by a key, where many pages show it. */

import type { AlertCause, Severity, Urgency } from '../api/types';
import { translate } from './language';

export const severity = translate('severity', {
  notice: 'Notice',
  warning: 'Warning',
  critical: 'Critical',
} satisfies Record<Severity, string>);

export const alertCause = translate('alertCause', {
  deviation_over_limit: 'Deviation over the limit',
  reference_fault: 'Gyro and satellite compass disagree',
  compass_fault: 'The compass is at fault',
  lightning_or_shock: 'Magnetism changed: lightning or a shock',
  magnetic_cargo: 'Magnetism changed: magnetic cargo',
  drift: 'Magnetism drifts',
  alignment: 'The compass’s zero moved',
  local_anomaly: 'Local anomaly',
  magnetic_storm: 'Magnetic storm',
  berth_steel: 'Steel at the berth',
  gnss_interference: 'GNSS interference',
  unknown_change: 'Magnetism changed: cause unknown',
  reported_aboard: 'Compass and gyro parted, says the ship',
  silent_agent: 'No word from the vessel',
  adjustment_not_confirmed: 'The sea does not confirm an adjustment',
  agreed_job_at_risk: 'An agreed adjustment does not fit any more',
  cloned_agent: 'Two computers send as one agent',
  no_model: 'No model of the compass yet',
  wide_band: 'The model is too uncertain',
} satisfies Record<AlertCause, string>);

export const urgency = translate('urgency', {
  routine: 'Routine',
  unknown: 'Not known',
  soon: 'Soon',
  urgent: 'Urgent',
  overdue: 'Overdue',
} satisfies Record<Urgency, string>);

/** How large a deviation is. */
export const grade = translate('grade', {
  small: 'small',
  notable: 'notable',
  large: 'large',
});

export const gradeLong = translate('gradeLong', {
  small: 'Below 3° on every heading',
  notable: 'Between 3° and 5° on some heading',
  large: 'Above 5° on some heading: most flags ask for an adjustment',
});
