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
          : [{ part, name, urgency: null, value: value === null ? '' : String(value) }],
    ),
  );
}

/** What may be left empty: nobody has said how late a job may be. */
const mayBeUnsaid: ReadonlySet<string> = new Set(['late_days']);

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
    else if (urgency === null) parts[part][name] = Number(value);
    else
      parts[part][name] = {
        ...(parts[part][name] as Record<string, number> | undefined),
        [urgency]: Number(value),
      };
  }
  return { horizon_days: Number(horizonDays), ...parts } as ScheduleSettings;
}
