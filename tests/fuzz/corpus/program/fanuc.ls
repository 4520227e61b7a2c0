/PROG A
/POS
P[1:"a"]{
 GP1:
 UF : 0, UT : 1,
 J1= -1.5 deg, J2= 2 deg
};
P[2]{
 GP1:
 X = 1 mm, Y = 2 mm, Z = 3 mm, W = 4 deg, P = 5 deg, R = 6 deg
};
