/**
 * The schedule's many weights as three: cost, punctuality, stability. Each slider moves the
 * figures of its group together, in their present ratio to one of them that stands for the group.
 * Pure functions.
 */

import type { Field } from './rules';

export const groups = ['cost', 'punctuality', 'stability'] as const;
export type Group = (typeof groups)[number];

/** The figure that stands for a group, the others that move with it, and a slider's places. */
const of: Record<Group, { name: string; with: readonly string[]; places: readonly number[] }> = {
  cost: { name: 'early_eur_day', with: [], places: [0.75, 1.5, 3, 6, 12] },
  punctuality: {
    name: 'late_eur_day',
    with: ['unmet_eur', 'missed_eur', 'waiting_eur_day'],
    places: [125, 250, 500, 1000, 2000],
  },
  stability: {
    name: 'changed_eur',
    with: ['withdrawn_eur'],
    places: [37.5, 75, 150, 300, 600],
  },
};

export const mostPlaces = 4;

const isOf = (group: Group) => (field: Field) =>
  field.part === 'weights' &&
  (field.name === of[group].name || of[group].with.includes(field.name));

/** The figure that stands for a group, euros; nothing where it is no number. */
export function figureOf(fields: readonly Field[], group: Group): number | undefined {
  const found = fields.find(({ part, name }) => part === 'weights' && name === of[group].name);
  const value = Number(found?.value);
  return found && found.value.trim() !== '' && Number.isFinite(value) ? value : undefined;
}

/** The slider's place that is nearest to the present figure, from 0. */
export function placeOf(fields: readonly Field[], group: Group): number {
  const figure = figureOf(fields, group) ?? 0;
  const off = (place: number) => Math.abs(Math.log2(Math.max(figure, 0.01) / place));
  const { places } = of[group];
  return places.reduce((best, place, i) => (off(place) < off(places[best] ?? 1) ? i : best), 0);
}

/** Where the sliders stand that were moved since the figures were loaded or typed. */
export type Places = Partial<Record<Group, number>>;

/**
 * The figures with sliders at their places: always from the figures as they were loaded or typed,
 * so that a slider's way back undoes its way there.
 */
export const positioned = (typed: readonly Field[], places: Places): Field[] =>
  groups.reduce<Field[]>(
    (fields, group) => {
      const place = places[group];
      return place === undefined ? fields : movedTo(fields, group, place);
    },
    [...typed],
  );

/** The largest figure that the server takes, euros. */
const mostEur = 1_000_000;

/** The figures with a group's slider at a place. */
export function movedTo(fields: readonly Field[], group: Group, place: number): Field[] {
  const to = of[group].places[place];
  const from = figureOf(fields, group);
  if (to === undefined) return [...fields];
  const inGroup = isOf(group);
  return fields.map((field) => {
    if (!inGroup(field)) return field;
    if (field.name === of[group].name) return { ...field, value: String(to) };
    if (from === undefined || from === 0 || !Number.isFinite(Number(field.value))) return field;
    const scaled = Math.min((Number(field.value) * to) / from, mostEur);
    return { ...field, value: String(Math.round(scaled * 100) / 100) };
  });
}
