/** What the components' tests share. */
import type { ModelVersion } from '../api/types';

/** What a reader without style sheets sees, in one line. */
export function words(rendered: { body: string }): string {
  return rendered.body
    .replace(/<!--.*?-->/gs, '')
    .replace(/<[^>]*>/g, ' ')
    .replace(/\s+/g, ' ')
    .trim();
}

/** A model of a ship whose own headings tell some of the parameters. */
export const version: ModelVersion = {
  id: 'm',
  foretold_by: null,
  version: 3,
  compass_id: 'c',
  epoch_from: null,
  epoch_to: null,
  data_from: '2026-09-01T00:00:00Z',
  data_until: '2026-11-01T00:00:00Z',
  created_at: '2026-11-01T00:10:00Z',
  input_hash: '0123456789abcdef',
  estimator: 'robust-1',
  lat: 54,
  lon: 10,
  h_nt: 18_000,
  z_nt: 46_000,
  handbook: { A: 0.3, B: 3.1, C: -2.2, D: 1, E: 0.1 },
  model: {
    version: 1,
    parameters_over_lambda: {
      bx_nt: 2060,
      chi13: -0.0215,
      by_nt: -2930,
      chi23: 0.0022,
      chi11_minus_chi22: 0.0352,
      chi12: 0.0012,
      chi21: 0.0016,
    },
    constant_deg: 0.3,
    covariance: Array.from({ length: 8 }, (_, i) =>
      Array.from({ length: 8 }, (_, j) => (i !== j ? 0 : i === 0 ? 100 ** 2 : 0.001 ** 2)),
    ),
    identifiable: {
      bx_nt: true,
      chi13: false,
      by_nt: true,
      chi23: false,
      chi11_minus_chi22: true,
      chi12: true,
      chi21: true,
      constant_deg: false,
    },
    rms_deg: 0.4,
    samples_used: 900,
    samples_rejected: 4,
  },
};
