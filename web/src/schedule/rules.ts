/** The schedule's weights and terms as the fields of a form. Pure. */

import type { ScheduleSettings } from '../api/types';

/** A figure of the settings: which part it is in, its name, and its urgency if it has one. */
export interface Field {
  part: 'weights' | 'terms';
  name: string;
  urgency: string | null;
  value: string;
}

/** A figure, one for each urgency, or none said. */
type Figure = number | Record<string, number> | null;

/** A form speaks of degrees where the server counts hundredths of one. */
const scaleOf = (name: string): number => (name.endsWith('_centideg') ? 100 : 1);

/** Every figure that the server knows, in its order. */
export function fieldsOf(settings: ScheduleSettings): Field[] {
  return (['weights', 'terms'] as const).flatMap((part) =>
    Object.entries((settings[part] ?? {}) as Record<string, Figure>).flatMap(
      ([name, value]): Field[] =>
        typeof value === 'object' && value !== null
          ? Object.entries(value).map(([urgency, figure]) => ({
              part,
              name,
              urgency,
              value: String(figure),
            }))
          : [
              {
                part,
                name,
                urgency: null,
                value: value === null ? '' : String(value / scaleOf(name)),
              },
            ],
    ),
  );
}

/** What may be left empty: nobody has said how late a job may be. */
const mayBeUnsaid: ReadonlySet<string> = new Set(['late_days']);

function numberOf(name: string, value: string): number {
  const scale = scaleOf(name);
  // 0.29 × 100 is not quite 29.
  return scale === 1 ? Number(value) : Math.round(Number(value) * scale);
}

/** The settings that such fields say, or the field that is no number. */
export function settingsOf(
  horizonDays: string,
  fields: readonly Field[],
): ScheduleSettings | { wrong: Field | null } {
  const isNumber = (text: string) => text.trim() !== '' && Number.isFinite(Number(text));
  if (!isNumber(horizonDays)) return { wrong: null };
  const isUnsaid = (field: Field) => mayBeUnsaid.has(field.name) && field.value.trim() === '';
  const wrong = fields.find((field) => !isUnsaid(field) && !isNumber(field.value));
  if (wrong) return { wrong };
  const parts: Record<Field['part'], Record<string, unknown>> = { weights: {}, terms: {} };
  for (const field of fields) {
    const { part, name, urgency, value } = field;
    if (isUnsaid(field)) parts[part][name] = null;
    else if (urgency === null) parts[part][name] = numberOf(name, value);
    else
      parts[part][name] = {
        ...(parts[part][name] as Record<string, number> | undefined),
        [urgency]: Number(value),
      };
  }
  return { horizon_days: Number(horizonDays), ...parts } as ScheduleSettings;
}
