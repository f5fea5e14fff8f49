/* Unit quaternions x, y, z, w. All real-time; results may be written onto an argument. */
#ifndef STIC_QUATERNION_H
#define STIC_QUATERNION_H

/* a after b: out = a b. */
void stic_quaternion_multiply(const double a[4], const double b[4], double out[4]);

/* Length 1; the identity for what has none. */
void stic_quaternion_normalize(double q[4]);

/* exp(v / 2): the turn by |v| rad about v. */
void stic_quaternion_from_turn(const double v[3], double out[4]);

/* 2 log(q): the turn of at most half a circle, rad, as a vector. */
void stic_quaternion_to_turn(const double q[4], double v[3]);

/* The rotation of a proper 3x3 matrix, row by row; w >= 0. */
void stic_quaternion_from_matrix(const double m[9], double out[4]);

#endif
