/** A text of the same shape: the same keys, and functions of the same values. */
export type Translation<T> = T extends string
  ? string
  : T extends (...values: infer Values) => infer Said
    ? (...values: Values) => Translation<Said>
    : { [Key in keyof T]: Translation<T[Key]> };
