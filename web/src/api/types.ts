/** The server's vocabulary, by the names the dashboard uses. */

export type Role = 'admin' | 'viewer' | 'platform_admin';

export interface Me {
  user_id: string;
  email: string;
  name: string;
  role: Role;
  operator_id: string | null;
  operator_name: string | null;
}

export interface Compass {
  id: string;
  name: string;
  role: 'standard' | 'steering' | 'transmitting';
}

export interface ModelSummary {
  id: string;
  version: number;
  data_until: string;
  rms_deg: number | null;
  samples_used: number;
}

export interface Worst {
  compass_deg: number;
  deviation_deg: number;
  band95_deg: number | null;
}

export interface Vessel {
  id: string;
  name: string;
  imo_number: string | null;
  call_sign: string | null;
  flag: string | null;
  created_at: string;
  last_upload_at: string | null;
  last_position: { lat: number; lon: number; at: string } | null;
  compasses: Compass[];
  model: ModelSummary | null;
  worst: Worst | null;
  open_alerts: number;
}

export interface NewVessel {
  name: string;
  imo_number?: string;
  call_sign?: string;
  flag?: string;
}

export interface Parameters {
  bx_nt: number;
  chi13: number;
  by_nt: number;
  chi23: number;
  chi11_minus_chi22: number;
  chi12: number;
  chi21: number;
}

export type ParameterName = keyof Parameters | 'constant_deg';

export interface Model {
  parameters_over_lambda: Parameters;
  constant_deg: number;
  covariance: number[][] | null;
  identifiable: Record<ParameterName, boolean> | null;
  rms_deg: number | null;
  samples_used: number;
  samples_rejected: number;
}

export interface Handbook {
  A: number;
  B: number;
  C: number;
  D: number;
  E: number;
}

export interface ModelVersion {
  id: string;
  version: number;
  compass_id: string;
  epoch_from: string;
  epoch_to: string | null;
  data_from: string;
  data_until: string;
  created_at: string;
  input_hash: string;
  estimator: string;
  h_nt: number;
  z_nt: number;
  handbook: Handbook;
  model: Model;
}

export interface DeviationRow {
  compass_deg: number;
  magnetic_deg: number;
  deviation_deg: number;
  band95_deg: number | null;
}

export interface DeviationTable {
  lat: number;
  lon: number;
  at: string;
  variation_deg: number;
  h_nt: number;
  z_nt: number;
  model_id: string;
  model_version: number;
  rows: DeviationRow[];
}

export interface Sample {
  time: string;
  lat: number;
  lon: number;
  compass_deg: number;
  gyro_deg: number | null;
  satellite_deg: number | null;
  windows: number;
  variation_deg: number;
  h_nt: number;
  z_nt: number;
  deviation_deg: number;
  predicted_deg: number | null;
  residual_deg: number | null;
  weight: number | null;
  used: boolean;
}

export interface CoverageCell {
  heading_from_deg: number;
  magnetic_latitude_from_deg: number;
  samples: number;
}

export interface Coverage {
  magnetic_latitude_step_deg: number;
  heading_step_deg: number;
  cells: CoverageCell[];
}

export interface AgentStream {
  stream: string;
  compass_id: string;
  compass_name: string;
  agent_version: string;
  opened_at: string;
  last_upload_at: string | null;
  contiguous_seq: number;
  batches: number;
  samples: number;
  tally: Record<string, number>;
}

export interface EnrolmentCode {
  code: string;
  expires_at: string;
}

export interface Page<T> {
  items: T[];
  next: string | null;
}
