#declare X = 1;
