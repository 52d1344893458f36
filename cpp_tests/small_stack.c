/* What a call needs of its thread's stack, RAYC_STACK_NEEDED of it by the header: every kind of query, in a thread that has
   no more. With the argument "least" it prints instead how little is enough. */
